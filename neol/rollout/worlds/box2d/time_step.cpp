#include "time_step.hpp"

#include <Box2D/Collision/b2TimeOfImpact.h>
#include <Box2D/Dynamics/Contacts/b2ContactSolver.h>
#include <Box2D/Dynamics/b2Island.h>

#include <cstring>

#include "shortcut.hpp"

namespace neol {

namespace {

bool is_static(const b2Body* body) { return body->GetType() == b2_staticBody; }

// The velocity iterations of an impact, without those that only repeat, as in shortcut.hpp. There
// are no joints, so all that they change is compared.
void iterate_impact(b2Island& island, b2ContactSolver& solver, int iterations) {
  struct Impulses {
    float normal[b2_maxManifoldPoints], tangent[b2_maxManifoldPoints];
  };
  const auto impulses = [&](int contact) {
    const auto& points = solver.m_velocityConstraints[contact].points;
    return Impulses{{points[0].normalImpulse, points[1].normalImpulse},
                    {points[0].tangentImpulse, points[1].tangentImpulse}};
  };
  b2Velocity velocities[2 * b2_maxTOIContacts];
  Impulses saved[b2_maxTOIContacts];
  const std::size_t size = static_cast<std::size_t>(island.m_bodyCount) * sizeof velocities[0];
  const auto has_come_back = [&] {
    if (std::memcmp(velocities, island.m_velocities, size) != 0) return false;
    for (int i = 0; i < island.m_contactCount; ++i) {
      const Impulses now = impulses(i);
      if (std::memcmp(&now, &saved[i], sizeof now) != 0) return false;
    }
    return true;
  };
  int saved_at = 0;
  SavePoints save_points;
  for (int done = 1; done <= iterations; ++done) {
    solver.SolveVelocityConstraints();
    if (saved_at > 0 && has_come_back()) {
      for (int rest = (iterations - done) % (done - saved_at); rest > 0; --rest)
        solver.SolveVelocityConstraints();
      return;
    }
    if (save_points.is_due(done)) {
      std::memcpy(velocities, island.m_velocities, size);
      for (int i = 0; i < island.m_contactCount; ++i) saved[i] = impulses(i);
      saved_at = done;
    }
  }
}

// b2Island::SolveTOI.
void solve_impact_island(b2Island& island, const b2TimeStep& step, int index_a, int index_b) {
  for (int i = 0; i < island.m_bodyCount; ++i) {
    const b2Body& body = *island.m_bodies[i];
    island.m_positions[i] = {body.m_sweep.c, body.m_sweep.a};
    island.m_velocities[i] = {body.m_linearVelocity, body.m_angularVelocity};
  }
  b2ContactSolverDef definition;
  definition.contacts = island.m_contacts;
  definition.count = island.m_contactCount;
  definition.allocator = island.m_allocator;
  definition.step = step;
  definition.positions = island.m_positions;
  definition.velocities = island.m_velocities;
  b2ContactSolver solver(&definition);
  for (int i = 0; i < step.positionIterations; ++i)
    if (solver.SolveTOIPositionConstraints(index_a, index_b)) break;
  for (const int index : {index_a, index_b}) {
    island.m_bodies[index]->m_sweep.c0 = island.m_positions[index].c;
    island.m_bodies[index]->m_sweep.a0 = island.m_positions[index].a;
  }
  solver.InitializeVelocityConstraints();
  iterate_impact(island, solver, step.velocityIterations);

  const float h = step.dt;
  for (int i = 0; i < island.m_bodyCount; ++i) {
    b2Body& body = *island.m_bodies[i];
    b2Vec2 v = island.m_velocities[i].v;
    float w = island.m_velocities[i].w;
    const b2Vec2 translation = h * v;
    if (b2Dot(translation, translation) > b2_maxTranslationSquared)
      v *= b2_maxTranslation / translation.Length();
    const float rotation = h * w;
    if (rotation * rotation > b2_maxRotationSquared) w *= b2_maxRotation / b2Abs(rotation);
    body.m_sweep.c = island.m_positions[i].c + h * v;
    body.m_sweep.a = island.m_positions[i].a + h * w;
    body.m_linearVelocity = v;
    body.m_angularVelocity = w;
    body.SynchronizeTransform();
  }
}

}  // namespace

void TimeStep::attach(b2World* world) {
  world_ = world;
  island.attach(world);
  ground_is_reset_ = false;
}

bool TimeStep::begin(float seconds, int velocity_iterations, int position_iterations) {
  if (world_->m_flags & b2World::e_newFixture) {
    find_first_contacts();
    world_->m_flags &= ~b2World::e_newFixture;
  }
  world_->m_flags |= b2World::e_locked;
  step_.dt = seconds;
  step_.inv_dt = 1.0f / seconds;
  step_.dtRatio = world_->m_inv_dt0 * seconds;
  step_.velocityIterations = velocity_iterations;
  step_.positionIterations = position_iterations;
  step_.warmStarting = true;
  world_->m_contactManager.Collide();
  return ordinary_ = island.read(step_);
}

// Leaves out the pieces of the ground, which cannot touch each other.
void TimeStep::find_first_contacts() {
  b2BroadPhase& broad_phase = world_->m_contactManager.m_broadPhase;
  for (int i = 0; i < broad_phase.m_moveCount; ++i) {
    int32& moved = broad_phase.m_moveBuffer[i];
    const auto* proxy = static_cast<b2FixtureProxy*>(broad_phase.GetUserData(moved));
    if (is_static(proxy->fixture->m_body)) moved = b2BroadPhase::e_nullProxy;
  }
  world_->m_contactManager.FindNewContacts();
}

void TimeStep::take(float seconds, int velocity_iterations, int position_iterations) {
  if (begin(seconds, velocity_iterations, position_iterations)) {
    solve_velocities(island, velocity_iterations);
    integrate();
    solve_places(island, position_iterations);
  }
  finish();
}

void TimeStep::finish() {
  if (ordinary_ && island.is_finite()) {
    island.write(step_);
    synchronize_fixtures();
    world_->m_contactManager.FindNewContacts();
  } else {
    world_->Solve(step_);
  }
  solve_impacts();
  world_->m_inv_dt0 = step_.inv_dt;
  for (int i = 0; i < island.bodies; ++i) {
    island.body[i]->m_force.SetZero();
    island.body[i]->m_torque = 0.0f;
  }
  world_->m_flags &= ~b2World::e_locked;
}

// In the order of the world's list, which decides the shape of the broad phase's tree.
void TimeStep::synchronize_fixtures() {
  for (b2Body* body = world_->m_bodyList; body && !is_static(body); body = body->m_next)
    body->SynchronizeFixtures();
}

// b2World::SolveTOI.
void TimeStep::solve_impacts() {
  for (int i = 0; i < island.bodies; ++i) {
    island.body[i]->m_flags &= static_cast<uint16>(~b2Body::e_islandFlag);
    island.body[i]->m_sweep.alpha0 = 0.0f;
  }
  if (!ground_is_reset_)
    for (b2Body* body = world_->m_bodyList; body; body = body->m_next)
      if (is_static(body)) body->m_sweep.alpha0 = 0.0f;
  ground_is_reset_ = true;
  b2Contact* const& first = world_->m_contactManager.m_contactList;
  for (b2Contact* contact = first; contact; contact = contact->m_next) {
    contact->m_flags &= ~static_cast<uint32>(b2Contact::e_toiFlag | b2Contact::e_islandFlag);
    contact->m_toiCount = 0;
    contact->m_toi = 1.0f;
  }
  for (;;) {
    b2Contact* earliest = nullptr;
    float fraction = 1.0f;
    for (b2Contact* contact = first; contact; contact = contact->m_next)
      if (update_impact(contact) && contact->m_toi < fraction) {
        earliest = contact;
        fraction = contact->m_toi;
      }
    if (!earliest || 1.0f - 10.0f * b2_epsilon < fraction) break;
    solve_impact(earliest, fraction);
  }
  // Box2D does this before each step, for all of the ground.
  for (b2Contact* contact = first; contact; contact = contact->m_next)
    for (const b2Fixture* fixture : {contact->m_fixtureA, contact->m_fixtureB})
      if (is_static(fixture->m_body)) fixture->m_body->m_sweep.alpha0 = 0.0f;
}

// Updates the time of a contact's impact; returns whether it has to be considered.
bool TimeStep::update_impact(b2Contact* contact) {
  if (!contact->IsEnabled() || contact->m_toiCount > b2_maxSubSteps) return false;
  if (contact->m_flags & b2Contact::e_toiFlag) return true;
  const b2Fixture *fixture_a = contact->m_fixtureA, *fixture_b = contact->m_fixtureB;
  b2Body *a = fixture_a->m_body, *b = fixture_b->m_body;
  if (!(a->IsAwake() && !is_static(a)) && !(b->IsAwake() && !is_static(b))) return false;
  const float begin = b2Max(a->m_sweep.alpha0, b->m_sweep.alpha0);
  for (b2Body* body : {a, b})
    if (body->m_sweep.alpha0 < begin) body->m_sweep.Advance(begin);
  b2Assert(begin < 1.0f);

  b2TOIInput input;
  input.proxyA.Set(fixture_a->GetShape(), contact->m_indexA);
  input.proxyB.Set(fixture_b->GetShape(), contact->m_indexB);
  input.sweepA = a->m_sweep;
  input.sweepB = b->m_sweep;
  input.tMax = 1.0f;
  b2TOIOutput output;
  b2TimeOfImpact(&output, &input);
  contact->m_toi = output.state == b2TOIOutput::e_touching
                       ? b2Min(begin + (1.0f - begin) * output.t, 1.0f)
                       : 1.0f;
  contact->m_flags |= b2Contact::e_toiFlag;
  return true;
}

void TimeStep::solve_impact(b2Contact* contact, float fraction) {
  b2ContactListener* listener = world_->m_contactManager.m_contactListener;
  b2Body* const bodies[] = {contact->m_fixtureA->m_body, contact->m_fixtureB->m_body};
  const b2Sweep sweeps[] = {bodies[0]->m_sweep, bodies[1]->m_sweep};
  for (b2Body* body : bodies) body->Advance(fraction);
  contact->Update(listener);
  contact->m_flags &= ~static_cast<uint32>(b2Contact::e_toiFlag);
  ++contact->m_toiCount;
  if (!contact->IsEnabled() || !contact->IsTouching()) {
    contact->SetEnabled(false);
    for (int i = 0; i < 2; ++i) {
      bodies[i]->m_sweep = sweeps[i];
      bodies[i]->SynchronizeTransform();
    }
    return;
  }

  b2Island impact(2 * b2_maxTOIContacts, b2_maxTOIContacts, 0, &world_->m_stackAllocator, listener);
  const auto add = [&](b2Body* body) {
    body->SetAwake(true);
    body->m_flags |= b2Body::e_islandFlag;
    impact.Add(body);
  };
  for (b2Body* body : bodies) add(body);
  impact.Add(contact);
  contact->m_flags |= b2Contact::e_islandFlag;
  for (b2Body* body : bodies) {
    if (is_static(body)) continue;
    for (b2ContactEdge* edge = body->m_contactList; edge; edge = edge->next) {
      if (impact.m_bodyCount == impact.m_bodyCapacity ||
          impact.m_contactCount == impact.m_contactCapacity)
        break;
      b2Contact* also = edge->contact;
      b2Body* other = edge->other;
      if (also->m_flags & b2Contact::e_islandFlag || !is_static(other)) continue;
      const b2Sweep sweep = other->m_sweep;
      const bool known = other->m_flags & b2Body::e_islandFlag;
      if (!known) other->Advance(fraction);
      also->Update(listener);
      if (!also->IsEnabled() || !also->IsTouching()) {
        other->m_sweep = sweep;
        other->SynchronizeTransform();
        continue;
      }
      also->m_flags |= b2Contact::e_islandFlag;
      impact.Add(also);
      if (!known) add(other);
    }
  }

  b2TimeStep rest;
  rest.dt = (1.0f - fraction) * step_.dt;
  rest.inv_dt = 1.0f / rest.dt;
  rest.dtRatio = 1.0f;
  rest.positionIterations = 20;
  rest.velocityIterations = step_.velocityIterations;
  rest.warmStarting = false;
  solve_impact_island(impact, rest, bodies[0]->m_islandIndex, bodies[1]->m_islandIndex);

  for (int i = 0; i < impact.m_bodyCount; ++i) {
    b2Body* body = impact.m_bodies[i];
    body->m_flags &= static_cast<uint16>(~b2Body::e_islandFlag);
    if (is_static(body)) continue;
    body->SynchronizeFixtures();
    for (b2ContactEdge* edge = body->m_contactList; edge; edge = edge->next)
      edge->contact->m_flags &=
          ~static_cast<uint32>(b2Contact::e_toiFlag | b2Contact::e_islandFlag);
  }
  world_->m_contactManager.FindNewContacts();
}

}  // namespace neol
