// BipedalWalker-v3, normal and hardcore, as in gymnasium/envs/box2d/bipedal_walker.py, to the last
// bit: doubles where Python has floats, in the same order, and floats where Box2D has them.
#pragma once

#include <algorithm>
#include <cmath>
#include <vector>

#include "simulation.hpp"

namespace neol {

class BipedalWalker final : public Simulation {
 public:
  explicit BipedalWalker(bool with_obstacles) : hardcore(with_obstacles) {
    for (int i = 0; i < lidar_count; ++i)
      rays[i] = {std::sin(1.5 * i / 10.0) * lidar_range, std::cos(1.5 * i / 10.0) * lidar_range};
  }

  // The action: torques of hip, knee, hip and knee, each in [-1, 1].
  void act(const float* action) override {
    for (int i = 0; i < joint_count; ++i) {
      const float speed = static_cast<float>(i % 2 == 0 ? hip_speed : knee_speed);
      joints[i]->SetMotorSpeed(speed * sign(action[i]));
      joints[i]->SetMaxMotorTorque(static_cast<float>(motor_torque) * effort(action[i]));
    }
  }

  void sense_plainly() override {
    for (int i = 0; i < lidar_count; ++i) cast_plainly(i);
  }

  // The same without searching the broad phase's tree, whose result, the nearest hit, does not
  // depend on the order of the search. The rays are so short and so near the origin that a hit lies
  // within 0.001 of both the ray and the obstacle, rounding included: on the ray because the
  // fraction is in [0, 1]; on an edge because the fraction is numerator / denominator of the
  // distance from the edge's line, exact to a few roundings of numbers below 200, and the
  // projection is on the edge; on a block because the ray was clipped at each of its four
  // axis-parallel sides. So an obstacle farther than `margin` from the ray's box cannot be hit. All
  // others are in the tree's boxes, which are 0.1 wider.
  void sense() override {
    const b2Vec2 position = hull->GetPosition();
    const bool near = std::abs(position.x) < 150 && std::abs(position.y) < 150;
    for (int i = 0; i < lidar_count; ++i)
      if (!near || !cast_nearby(i)) cast_plainly(i);
  }

  bool observe(const float* action, double* observation, double* reward) override {
    const b2Vec2 position = hull->GetPosition();
    const b2Vec2 velocity = hull->GetLinearVelocity();
    double state[14 + lidar_count] = {
        hull->GetAngle(),
        2.0 * hull->GetAngularVelocity() / frames_per_second,
        0.3 * velocity.x * viewport_width / frames_per_second,
        0.3 * velocity.y * viewport_height / frames_per_second,
        joints[0]->GetJointAngle(),
        joints[0]->GetJointSpeed() / hip_speed,
        joints[1]->GetJointAngle() + 1.0,
        joints[1]->GetJointSpeed() / knee_speed,
        contacts.grounded[0] ? 1.0 : 0.0,
        joints[2]->GetJointAngle(),
        joints[2]->GetJointSpeed() / hip_speed,
        joints[3]->GetJointAngle() + 1.0,
        joints[3]->GetJointSpeed() / knee_speed,
        contacts.grounded[1] ? 1.0 : 0.0,
    };
    for (int i = 0; i < lidar_count; ++i) state[14 + i] = lidar[i].fraction;
    write(state, observation);

    const double shaping = 130 * double{position.x} / scale - 5.0 * std::abs(state[0]);
    float net = static_cast<float>(gain(shaping));  // NumPy continues in the action's dtype
    for (int i = 0; i < joint_count; ++i)
      net -= static_cast<float>(0.00035 * motor_torque) * effort(action[i]);

    const bool fallen = contacts.crashed || position.x < 0;
    const bool finished = position.x > (terrain_length - terrain_grass) * terrain_step;
    *reward = fallen ? -100.0 : net;
    return fallen || finished;
  }

 private:
  static constexpr int joint_count = 4;
  static constexpr double motor_torque = 80, hip_speed = 4, knee_speed = 6;
  static constexpr double initial_force = 5;
  static constexpr double leg_down = -8 / scale, leg_width = 8 / scale, leg_height = 34 / scale;
  static constexpr double terrain_step = 14 / scale;
  static constexpr double terrain_height = viewport_height / 4;
  static constexpr int terrain_length = 200, terrain_grass = 10, terrain_start = 20;
  static constexpr float terrain_friction = 2.5f;
  static constexpr int lidar_count = 10;
  static constexpr double lidar_range = 160 / scale;

  // Numpy's sign and abs-then-clip, NaN included.
  template <class Real>
  static Real sign(Real x) {
    return x > 0 ? Real{1} : x < 0 ? Real{-1} : x == 0 ? Real{0} : x;
  }
  static float effort(float action) { return std::min(std::abs(action), 1.0f); }

  // Keeps the nearest point of the ground.
  struct Lidar final : b2RayCastCallback {
    float fraction = 1.0f;
    float ReportFixture(b2Fixture* fixture, const b2Vec2&, const b2Vec2&, float hit) override {
      if ((fixture->GetFilterData().categoryBits & ground) == 0) return -1.0f;
      return fraction = hit;
    }
  };

  b2Vec2 ray_end(int i) const {
    const b2Vec2 position = hull->GetPosition();
    return Point{position.x + rays[i].x, position.y - rays[i].y};
  }

  void cast_plainly(int i) {
    lidar[i].fraction = 1.0f;
    world->RayCast(&lidar[i], hull->GetPosition(), ray_end(i));
  }

  // Whether the nearest hit was found. A fraction of zero would end Box2D's search early.
  bool cast_nearby(int i) {
    constexpr float margin = 0.05f;
    b2RayCastInput ray;
    ray.p1 = hull->GetPosition();
    ray.p2 = ray_end(i);  // to the right, or straight down
    ray.maxFraction = 1.0f;
    const float top = ray.p1.y + margin, bottom = ray.p2.y - margin;
    float right = ray.p2.x + margin;
    const auto cast = [&](const Obstacle& obstacle) {
      b2RayCastOutput hit;
      if (obstacle.bottom > top || obstacle.top < bottom || obstacle.right < ray.p1.x - margin ||
          !obstacle.fixture->RayCast(&hit, ray, 0))
        return;
      ray.maxFraction = hit.fraction;
      right = ray.p1.x + hit.fraction * (ray.p2.x - ray.p1.x) + margin;
    };
    const int column = static_cast<int>((ray.p1.x - margin) / terrain_step) - 1;
    for (int k = std::max(column, 0); k < terrain_length - 1 && edges[k].left <= right; ++k)
      cast(edges[k]);
    for (const Obstacle& block : blocks)
      if (block.left <= right) cast(block);
    lidar[i].fraction = ray.maxFraction;
    return ray.maxFraction > 0.0f;
  }

  void add_block(double left, double right, double bottom, double top) {
    const auto block = polygon({{left, top}, {right, top}, {right, bottom}, {left, bottom}});
    blocks.push_back(add_obstacle(block));
  }

  // A piece of the ground, and the box around it.
  struct Obstacle {
    const b2Fixture* fixture;
    float left, right, bottom, top;
  };
  Obstacle add_obstacle(const b2Shape& shape) {
    b2Body* body = add_ground();
    add_fixture(body, shape, terrain_friction);
    b2AABB box;
    shape.ComputeAABB(&box, body->GetTransform(), 0);
    return {body->GetFixtureList(), box.lowerBound.x, box.upperBound.x, box.lowerBound.y,
            box.upperBound.y};
  }

  void build() override {
    blocks.clear();
    add_terrain();
    for (int draw = 0; draw < 10 * (1 + 5 * 2); ++draw) random.random();  // ten clouds
    add_walker();
  }

  // Gymnasium's _generate_terrain: grass, and in hardcore a stump, stairs or a pit after each
  // stretch of it. `begins` marks the first column of a stretch, where an obstacle is built.
  void add_terrain() {
    enum { grass, stump, stairs, pit, kinds };
    int kind = grass;
    int counter = terrain_start;
    bool begins = false;
    double velocity = 0.0, y = terrain_height, original_y = 0.0;
    int steps = 0, width = 0, rise = 0;
    Point surface[terrain_length];

    for (int i = 0; i < terrain_length; ++i) {
      const double x = i * terrain_step;
      if (kind == grass && !begins) {
        velocity = 0.8 * velocity + 0.01 * sign(terrain_height - y);
        if (i > terrain_start) velocity += random.uniform(-1, 1) / scale;
        y += velocity;
      } else if (kind == pit && begins) {
        counter = random.integers(3, 5);
        const double shift = terrain_step * counter, bottom = y - 4 * terrain_step;
        add_block(x, x + terrain_step, bottom, y);
        add_block(x + shift, x + terrain_step + shift, bottom, y);
        counter += 2;
        original_y = y;
      } else if (kind == pit) {
        y = original_y;
        if (counter > 1) y -= 4 * terrain_step;
      } else if (kind == stump && begins) {
        counter = random.integers(1, 3);
        const double size = counter * terrain_step;
        add_block(x, x + size, y, y + size);
      } else if (kind == stairs && begins) {
        rise = random.random() > 0.5 ? +1 : -1;
        width = random.integers(4, 5);
        steps = random.integers(3, 5);
        original_y = y;
        for (int s = 0; s < steps; ++s)
          add_block(x + s * width * terrain_step, x + (1 + s) * width * terrain_step,
                    y + (-1 + s * rise) * terrain_step, y + s * rise * terrain_step);
        counter = steps * width;
      } else if (kind == stairs) {
        const double n = static_cast<double>(steps * width - counter - rise) / width;
        y = original_y + n * rise * terrain_step;
      }
      begins = false;
      surface[i] = {x, y};
      if (--counter == 0) {
        counter = random.integers(terrain_grass / 2, terrain_grass);
        kind = kind == grass && hardcore ? random.integers(1, kinds) : int{grass};
        begins = true;
      }
    }
    for (int i = 0; i + 1 < terrain_length; ++i)
      edges[i] = add_obstacle(edge(surface[i], surface[i + 1]));
  }

  void add_walker() {
    const Point start{terrain_step * terrain_start / 2, terrain_height + 2 * leg_height};
    const auto trunk = polygon({{-30, +9}, {+6, +9}, {+34, +1}, {+34, -8}, {-30, -8}}, scale);
    const auto upper_leg = box(leg_width / 2, leg_height / 2);
    const auto lower_leg = box(0.8 * leg_width / 2, leg_height / 2);

    hull = add_part(start, 0, trunk, 0.1f, 5.0f);
    const double force = random.uniform(-initial_force, initial_force);
    hull->ApplyForceToCenter(Point{force, 0}, true);
    contacts.trunk = hull;
    for (const int side : {-1, +1}) {
      const int first = side + 1;  // joints 0, 1 and 2, 3
      b2Body* upper = add_part({start.x, start.y - leg_height / 2 - leg_down}, side * 0.05,
                               upper_leg, 0.2f, 1.0f);
      joints[first] =
          add_hinge(hull, upper, {0, leg_down}, {0, leg_height / 2}, -0.8, 1.1, motor_torque, side);
      b2Body* lower = add_part({start.x, start.y - leg_height * 3 / 2 - leg_down}, side * 0.05,
                               lower_leg, 0.2f, 1.0f);
      joints[first + 1] = add_hinge(upper, lower, {0, -leg_height / 2}, {0, leg_height / 2}, -1.6,
                                    -0.1, motor_torque, 1);
      contacts.feet[side > 0] = lower;
    }
  }

  bool hardcore;
  Point rays[lidar_count];
  Lidar lidar[lidar_count];
  Obstacle edges[terrain_length - 1];  // from left to right
  std::vector<Obstacle> blocks;
  b2Body* hull = nullptr;
  b2RevoluteJoint* joints[joint_count] = {};
};

}  // namespace neol
