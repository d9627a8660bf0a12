// What the environments share: the life of an episode, its contacts, and shorthands that round
// Gymnasium's double coordinates to Box2D's floats exactly where pybox2d does.
#pragma once

#include <Box2D/Box2D.h>

#include <initializer_list>
#include <memory>
#include <optional>

#include "pcg64.hpp"
#include "time_step.hpp"

namespace neol {

constexpr double frames_per_second = 50;
constexpr double scale = 30;
constexpr double viewport_width = 600 / scale;
constexpr double viewport_height = 400 / scale;

struct Point {
  double x, y;
  operator b2Vec2() const { return {static_cast<float>(x), static_cast<float>(y)}; }
};

// Gymnasium's ContactDetector: the trunk must touch nothing; of each foot, the latest event
// tells whether it is on the ground.
struct Contacts final : b2ContactListener {
  const b2Body* trunk = nullptr;
  const b2Body* feet[2] = {};
  bool crashed = false;
  bool grounded[2] = {};

  void BeginContact(b2Contact* contact) override { report(contact, true); }
  void EndContact(b2Contact* contact) override { report(contact, false); }

  void report(b2Contact* contact, bool begins) {
    for (b2Fixture* fixture : {contact->GetFixtureA(), contact->GetFixtureB()}) {
      if (begins && fixture->GetBody() == trunk) crashed = true;
      for (int i = 0; i < 2; ++i)
        if (fixture->GetBody() == feet[i]) grounded[i] = begins;
    }
  }
};

class Simulation {
 public:
  virtual ~Simulation() = default;

  // Starts an episode and, as Gymnasium does, takes an idle step.
  void reset(const Pcg64& stream, double* observation) {
    begin(stream);
    double reward;
    step(idle, observation, &reward);
  }

  // The same without the step. The world is new, so no earlier episode can affect this one.
  void begin(const Pcg64& stream) {
    world = std::make_unique<b2World>(Point{0, -10});
    world->SetContactListener(&(contacts = {}));
    previous_shaping.reset();
    random = stream;
    build();
    time_step.attach(world.get());
    failed = false;
  }

  // Takes a step; returns whether the episode has terminated.
  bool step(const float* action, double* observation, double* reward) {
    act(action);
    time_step.take(seconds, velocity_iterations, position_iterations);
    sense();
    return observe(action, observation, reward);
  }

  // The physics of a step by Box2D's own loop, the reference for all other paths.
  void advance(const float* action) {
    act(action);
    world->Step(seconds, velocity_iterations, position_iterations);
    time_step.note_plain_step();
    sense_plainly();
  }

  // The parts of a step: the action's forces; after the world's time step the sensors' ray casts,
  // by our search and by Box2D's; then observation, reward and end.
  virtual void act(const float* action) = 0;
  virtual void sense() {}
  virtual void sense_plainly() {}

  virtual bool observe(const float* action, double* observation, double* reward) = 0;

  // Leaks a world in which Box2D has failed an assertion, because its destructor would fail
  // another.
  void abandon() { static_cast<void>(world.release()); }

  static constexpr float idle[4] = {};  // an action
  static constexpr float seconds = static_cast<float>(1 / frames_per_second);
  static constexpr int position_iterations = 2 * 30;
  int velocity_iterations = 6 * 30;

  std::unique_ptr<b2World> world;
  TimeStep time_step;   // takes all steps but those of `advance`
  bool failed = false;  // an assertion of Box2D, since the last reset

 protected:
  virtual void build() = 0;

  b2Body* add_ground() {
    const b2BodyDef definition;
    return world->CreateBody(&definition);
  }

  static void add_fixture(b2Body* body, const b2Shape& shape, float friction, float density = 0,
                          b2Filter filter = {}) {
    b2FixtureDef definition;
    definition.shape = &shape;
    definition.friction = friction;
    definition.density = density;
    definition.filter = filter;
    body->CreateFixture(&definition);
  }

  // A moving part, which collides with the ground only.
  b2Body* add_part(Point position, double angle, const b2Shape& shape, float friction,
                   float density) {
    b2BodyDef definition;
    definition.type = b2_dynamicBody;
    definition.position = position;
    definition.angle = static_cast<float>(angle);
    b2Filter filter;
    filter.categoryBits = part;
    filter.maskBits = ground;
    b2Body* body = world->CreateBody(&definition);
    add_fixture(body, shape, friction, density, filter);
    return body;
  }

  // A hinge with limits and a motor. Its angle is measured from the initial one, as pybox2d does.
  b2RevoluteJoint* add_hinge(b2Body* a, b2Body* b, Point anchor_a, Point anchor_b, double lower,
                             double upper, double torque, double speed) {
    b2RevoluteJointDef definition;
    definition.bodyA = a;
    definition.bodyB = b;
    definition.localAnchorA = anchor_a;
    definition.localAnchorB = anchor_b;
    definition.referenceAngle = b->GetAngle() - a->GetAngle();
    definition.enableLimit = definition.enableMotor = true;
    definition.lowerAngle = static_cast<float>(lower);
    definition.upperAngle = static_cast<float>(upper);
    definition.maxMotorTorque = static_cast<float>(torque);
    definition.motorSpeed = static_cast<float>(speed);
    return static_cast<b2RevoluteJoint*>(world->CreateJoint(&definition));
  }

  static b2EdgeShape edge(Point start, Point end) {
    b2EdgeShape shape;
    shape.Set(start, end);
    return shape;
  }

  static b2PolygonShape polygon(std::initializer_list<Point> corners, double unit = 1) {
    b2Vec2 vertices[b2_maxPolygonVertices];
    int count = 0;
    for (const auto& corner : corners) vertices[count++] = Point{corner.x / unit, corner.y / unit};
    b2PolygonShape shape;
    shape.Set(vertices, count);
    return shape;
  }

  static b2PolygonShape box(double half_width, double half_height) {
    b2PolygonShape shape;
    shape.SetAsBox(static_cast<float>(half_width), static_cast<float>(half_height));
    return shape;
  }

  // The step's increase of the shaping, which is part of the reward; 0 in an episode's first step.
  double gain(double shaping) {
    const double change = previous_shaping ? shaping - *previous_shaping : 0.0;
    previous_shaping = shaping;
    return change;
  }

  // Observations are Gymnasium's float32 values, held as doubles.
  template <std::size_t size>
  static void write(const double (&state)[size], double* observation) {
    for (std::size_t i = 0; i < size; ++i) observation[i] = static_cast<float>(state[i]);
  }

  static constexpr std::uint16_t ground = 0x0001, part = 0x0020;  // collision categories

  Contacts contacts;
  std::optional<double> previous_shaping;
  Pcg64 random;
};

}  // namespace neol
