// LunarLander-v3 (discrete, no wind) as in gymnasium/envs/box2d/lunar_lander.py, to the last bit:
// doubles where Python has floats, in the same order, and floats where Box2D has them.
#pragma once

#include <cmath>

#include "simulation.hpp"

namespace neol {

class LunarLander final : public Simulation {
 public:
  // The action is one number: 0 nothing, 1 left engine, 2 main engine, 3 right engine.
  void act(const float* action) override {
    const double angle = lander->GetAngle();
    const Point tip{std::sin(angle), std::cos(angle)};
    const Point side{-tip.y, tip.x};
    const double dispersion[] = {random.uniform(-1, 1) / scale, random.uniform(-1, 1) / scale};
    const Point position{lander->GetPosition().x, lander->GetPosition().y};

    if (*action == 2) {
      const double along = main_engine_y / scale + 2 * dispersion[0];
      const Point offset{tip.x * along + side.x * dispersion[1],
                         -tip.y * along - side.y * dispersion[1]};
      push(offset, main_engine_power, {position.x + offset.x, position.y + offset.y});
    } else if (*action != 0) {
      const double direction = *action - 2;
      const double across = 3 * dispersion[1] + direction * side_engine_away / scale;
      const Point offset{tip.x * dispersion[0] + side.x * across,
                         -tip.y * dispersion[0] - side.y * across};
      push(offset, side_engine_power,  // 17 and 14 differ in Gymnasium too
           {position.x + offset.x - tip.x * 17 / scale,
            position.y + offset.y + tip.y * side_engine_height / scale});
    }
  }

  bool observe(const float* action, double* observation, double* reward) override {
    const b2Vec2 position = lander->GetPosition();
    const b2Vec2 velocity = lander->GetLinearVelocity();
    const double state[8] = {
        (position.x - viewport_width / 2) / (viewport_width / 2),
        (position.y - (helipad_y + leg_down / scale)) / (viewport_height / 2),
        velocity.x * (viewport_width / 2) / frames_per_second,
        velocity.y * (viewport_height / 2) / frames_per_second,
        lander->GetAngle(),
        20.0 * lander->GetAngularVelocity() / frames_per_second,
        contacts.grounded[0] ? 1.0 : 0.0,
        contacts.grounded[1] ? 1.0 : 0.0,
    };
    write(state, observation);

    const double shaping = -100 * std::sqrt(state[0] * state[0] + state[1] * state[1]) -
                           100 * std::sqrt(state[2] * state[2] + state[3] * state[3]) -
                           100 * std::abs(state[4]) + 10 * state[6] + 10 * state[7];
    *reward = gain(shaping);
    if (*action == 2)
      *reward -= 0.30;
    else if (*action != 0)
      *reward -= 0.03;

    const bool lost = contacts.crashed || std::abs(state[0]) >= 1.0;
    const bool landed = !lander->IsAwake();
    if (lost) *reward = -100;
    if (landed) *reward = +100;
    return lost || landed;
  }

 private:
  static constexpr double main_engine_power = 13.0, main_engine_y = 4;
  static constexpr double side_engine_power = 0.6, side_engine_height = 14, side_engine_away = 12;
  static constexpr double initial_force = 1000.0;
  static constexpr double leg_away = 20, leg_down = 18, leg_width = 2, leg_height = 8;
  static constexpr double leg_spring_torque = 40;
  static constexpr double helipad_y = viewport_height / 4;

  void build() override {
    add_moon();
    add_lander();
  }

  void add_moon() {
    constexpr int chunks = 11;
    double height[chunks + 1];
    for (double& value : height) value = random.uniform(0, viewport_height / 2);
    for (int i = chunks / 2 - 2; i <= chunks / 2 + 2; ++i) height[i] = helipad_y;

    const auto corner = [&](int i) {
      const double before = height[i > 0 ? i - 1 : chunks];  // Python's height[-1]
      return Point{viewport_width / (chunks - 1) * i, 0.33 * (before + height[i] + height[i + 1])};
    };
    b2Body* moon = add_ground();
    add_fixture(moon, edge({0, 0}, {viewport_width, 0}), 0.2f);
    for (int i = 0; i < chunks - 1; ++i) add_fixture(moon, edge(corner(i), corner(i + 1)), 0.1f);
  }

  void add_lander() {
    const Point start{viewport_width / 2, viewport_height};
    const auto hull =
        polygon({{-14, +17}, {-17, 0}, {-17, -10}, {+17, -10}, {+17, 0}, {+14, +17}}, scale);
    lander = add_part(start, 0, hull, 0.1f, 5.0f);
    const double force_x = random.uniform(-initial_force, initial_force);
    const double force_y = random.uniform(-initial_force, initial_force);
    lander->ApplyForceToCenter(Point{force_x, force_y}, true);
    contacts.trunk = lander;

    for (const int side : {-1, +1}) {
      b2Body* leg = add_part({start.x - side * leg_away / scale, start.y}, side * 0.05,
                             box(leg_width / scale, leg_height / scale), 0.2f, 1.0f);
      const double lower = side < 0 ? 0.9 - 0.5 : -0.9;
      const double upper = side < 0 ? 0.9 : -0.9 + 0.5;
      add_hinge(lander, leg, {0, 0}, {side * leg_away / scale, leg_down / scale}, lower, upper,
                leg_spring_torque, 0.3 * side);
      contacts.feet[side > 0] = leg;
    }
  }

  void push(Point offset, double power, Point where) {
    lander->ApplyLinearImpulse(Point{-offset.x * power, -offset.y * power}, where, true);
  }

  b2Body* lander = nullptr;
};

}  // namespace neol
