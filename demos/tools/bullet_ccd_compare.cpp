// The contact of Bullet's own deformable world beside ours: the same particles fall on the same cloth, at the
// same speeds and time steps; how many pass?
//
//   bullet_ccd_compare [--quick]      exit 1 if Oilskin lets a particle through, or loses one
//
// Cloth: 0.4 m × 0.4 m, 21 × 21 nodes, 80 g, border pinned. Particles: 100 of 1 g each, 30 mm apart, off the
// nodes and edges, slightly slanted (Bullet's continuous test culls motion exactly along an axis), no
// gravity. One Bullet step of the given length at a time, single precision.
//
// Theirs: btDeformableMultiBodyDynamicsWorld, implicit, 10 solver iterations, mass–spring cloth. The
// particles are nodes of one btSoftBody; no forces act between them, but links and faces join them, since the
// continuous test goes from faces to faces and its trees are built along links. fCollision::VF_DD for contact
// between soft bodies (it turns the continuous test on), SDF_RD without which the trees of that contact are
// not built, repulsion stiffness by setSpringStiffness(). Contact begins at the sum of the two margins: once
// as large as is reasonable, 10 mm, and once as thin as ours, 1 mm.
// Ours: btFluidSoftBodySolver in a btSoftRigidDynamicsWorld, thickness 1 mm; the particles
// are a fluid of 10 mm spacing, too far apart to feel each other.
// None: no contact at all, as a check that every particle would pass.
//
// All are judged alike: by the straight path of each particle against those of the cloth's triangles in every
// step, with ContactSolver::count_crossings() on the positions that Bullet and the fluid store. A particle
// counts once.
#include <BulletDynamics/ConstraintSolver/btSequentialImpulseConstraintSolver.h>
#include <BulletSoftBody/btDeformableBodySolver.h>
#include <BulletSoftBody/btDeformableMassSpringForce.h>
#include <BulletSoftBody/btDeformableMultiBodyConstraintSolver.h>
#include <BulletSoftBody/btDeformableMultiBodyDynamicsWorld.h>
#include <BulletSoftBody/btSoftBodyHelpers.h>
#include <BulletSoftBody/btSoftBodyRigidBodyCollisionConfiguration.h>
#include <BulletSoftBody/btSoftRigidDynamicsWorld.h>

#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstring>
#include <memory>

#include "oilskin/bullet.h"

namespace {

using oilskin::Vec3;

constexpr int nodes_across = 21, particles_across = 10;
constexpr std::size_t particle_count = particles_across * particles_across;
constexpr double cloth_size = 0.4, cloth_mass = 0.08, start_height = 0.05, particle_mass = 0.001;

struct Case {
  double speed, dt;
};

btScalar bt(double x) {
  return static_cast<btScalar>(x);
}
btVector3 to_bt(const Vec3& x) {
  return {bt(x.x()), bt(x.y()), bt(x.z())};
}
Vec3 from_bt(const btVector3& x) {
  return {static_cast<double>(x.x()), static_cast<double>(x.y()), static_cast<double>(x.z())};
}

/// At mixed heights, so that no step length suits all.
Vec3 start_of(std::size_t i) {
  const double across = 0.03 * (particles_across - 1);
  const std::size_t column = i % particles_across, row = i / particles_across;
  return {0.03 * static_cast<double>(column) - 0.5 * across + 0.0037,
          start_height * (1 + std::fmod(0.618034 * static_cast<double>(i), 1)),
          0.03 * static_cast<double>(row) - 0.5 * across + 0.0019};
}

Vec3 velocity_of(double speed) {
  return speed * Vec3(0.06, -1, 0.03).normalized();
}

btSoftBody* make_cloth(btSoftBodyWorldInfo& info) {
  const btScalar r = bt(0.5 * cloth_size);
  btSoftBody* cloth = btSoftBodyHelpers::CreatePatch(info, {-r, 0, -r}, {r, 0, -r}, {-r, 0, r}, {r, 0, r},
                                                     nodes_across, nodes_across, 0, true);
  cloth->setTotalMass(bt(cloth_mass));
  for (int i = 0; i < cloth->m_nodes.size(); ++i) {
    const int u = i % nodes_across, v = i / nodes_across;
    if (u == 0 || v == 0 || u == nodes_across - 1 || v == nodes_across - 1) cloth->setMass(i, 0);
  }
  cloth->m_cfg.piterations = 10;
  cloth->getCollisionShape()->setMargin(bt(0.005));
  return cloth;
}

/// Judges one run: paths of particles against paths of triangles, step by step.
class Judge {
 public:
  explicit Judge(const btSoftBody& cloth) {
    sheet_.id = 1;
    sheet_.storage = oilskin::Storage::float32;
    const btSoftBody::Node* first = &cloth.m_nodes[0];
    for (int f = 0; f < cloth.m_faces.size(); ++f) {
      oilskin::Triangle triangle;
      for (std::size_t k = 0; k < 3; ++k)
        triangle[k] = static_cast<std::uint32_t>(cloth.m_faces[f].m_n[k] - first);
      sheet_.triangles.push_back(triangle);
    }
    sheet_.x_t1 = nodes_of(cloth);
    for (std::size_t i = 0; i < particle_count; ++i) {
      id_.push_back(i);
      x_t1_.push_back(start_of(i));
    }
  }

  /// The state after a step.
  void look(const btSoftBody& cloth, const std::vector<Vec3>& particles) {
    sheet_.x_t0 = sheet_.x_t1;
    sheet_.x_t1 = nodes_of(cloth);
    x_t0_ = x_t1_;
    x_t1_ = particles;
    if (crossings_among(through_) == 0) return;
    for (std::size_t i = 0; i < particle_count; ++i) {
      if (through_[i]) continue;
      std::vector<std::uint8_t> all_but_one(particle_count, 1);
      all_but_one[i] = 0;
      through_[i] = crossings_among(all_but_one) > 0;
    }
  }

  int through() const { return static_cast<int>(std::count(through_.begin(), through_.end(), 1)); }

 private:
  static std::vector<Vec3> nodes_of(const btSoftBody& cloth) {
    std::vector<Vec3> x;
    x.reserve(static_cast<std::size_t>(cloth.m_nodes.size()));
    for (int i = 0; i < cloth.m_nodes.size(); ++i) x.push_back(from_bt(cloth.m_nodes[i].m_x));
    return x;
  }

  std::uint64_t crossings_among(std::vector<std::uint8_t> left_out) {
    oilskin::ParticleMotion motion;
    motion.id = id_;
    motion.x_t0 = x_t0_;
    motion.x_t1 = x_t1_;
    motion.removed = left_out;
    oilskin::SurfaceMotion* surfaces[] = {&sheet_};
    return oilskin::ContactSolver::count_crossings(motion, surfaces);
  }

  oilskin::SurfaceMotion sheet_;
  std::vector<std::uint64_t> id_;
  std::vector<Vec3> x_t0_, x_t1_;
  std::vector<std::uint8_t> through_ = std::vector<std::uint8_t>(particle_count, 0);
};

/// Long enough for the slowest particle to arrive, and 50 ms more.
int steps_of(const Case& c) {
  return static_cast<int>(std::ceil((2.2 * start_height / c.speed + 0.05) / c.dt)) + 1;
}

int run_without_contact(const Case& c) {
  btSoftBodyWorldInfo info;
  const std::unique_ptr<btSoftBody> cloth(make_cloth(info));
  Judge judge(*cloth);
  std::vector<Vec3> x;
  for (std::size_t i = 0; i < particle_count; ++i) x.push_back(start_of(i));
  for (int k = 0; k < steps_of(c); ++k) {
    for (Vec3& p : x) p += c.dt * velocity_of(c.speed);
    judge.look(*cloth, x);
  }
  return judge.through();
}

/// Bullet's deformable world with the cloth in it.
class DeformableWorld {
 public:
  DeformableWorld()
      : dispatcher_(&configuration_),
        world(&dispatcher_, &broadphase_, &constraints_, &configuration_, &deformables_),
        springs_(bt(1000), bt(0.1), true) {
    constraints_.setDeformableSolver(&deformables_);
    world.setGravity(btVector3(0, 0, 0));
    world.getWorldInfo().m_gravity = btVector3(0, 0, 0);
    world.getWorldInfo().m_sparsesdf.Initialize();
    world.getWorldInfo().m_maxDisplacement = bt(10);  // it would clamp speeds otherwise
    world.getSolverInfo().m_numIterations = 10;
    world.setImplicit(true);
    cloth = make_cloth(world.getWorldInfo());
    add(cloth);
    world.addForce(cloth, &springs_);
  }
  ~DeformableWorld() {
    for (const auto& body : bodies_) {
      world.removeSoftBodyForce(body.get());
      world.removeSoftBody(body.get());
    }
  }

  void add(btSoftBody* body) {
    using Collision = btSoftBody::fCollision;
    bodies_.emplace_back(body);
    body->m_cfg.collisions = Collision::SDF_RD | Collision::VF_DD;
    body->m_cfg.kKHR = body->m_cfg.kCHR = 1;
    body->m_cfg.kDF = 0;
    body->setSpringStiffness(bt(1000));
    world.addSoftBody(body);
  }

 private:
  btSoftBodyRigidBodyCollisionConfiguration configuration_;
  btCollisionDispatcher dispatcher_;
  btDbvtBroadphase broadphase_;
  btDeformableBodySolver deformables_;
  btDeformableMultiBodyConstraintSolver constraints_;

 public:
  btDeformableMultiBodyDynamicsWorld world;
  btSoftBody* cloth;

 private:
  btDeformableMassSpringForce springs_;
  std::vector<std::unique_ptr<btSoftBody>> bodies_;
};

/// Contact begins at `reach` [m].
int run_theirs(const Case& c, double reach) {
  DeformableWorld host;
  const btVector3 o(0, 0, 0), u(1, 0, 0), v(0, 0, 1);
  btSoftBody* rain = btSoftBodyHelpers::CreatePatch(host.world.getWorldInfo(), o, u, v, u + v,
                                                    particles_across, particles_across, 0, false);
  for (int i = 0; i < rain->m_nodes.size(); ++i) {
    rain->m_nodes[i].m_x = rain->m_nodes[i].m_q = to_bt(start_of(static_cast<std::size_t>(i)));
    rain->setMass(i, bt(particle_mass));
  }
  for (btSoftBody* body : {rain, host.cloth}) body->getCollisionShape()->setMargin(bt(0.5 * reach));
  rain->setVelocity(to_bt(velocity_of(c.speed)));
  host.add(rain);
  Judge judge(*host.cloth);
  for (int k = 0; k < steps_of(c); ++k) {
    host.world.stepSimulation(bt(c.dt), 0);
    std::vector<Vec3> now;
    now.reserve(static_cast<std::size_t>(rain->m_nodes.size()));
    for (int i = 0; i < rain->m_nodes.size(); ++i) now.push_back(from_bt(rain->m_nodes[i].m_x));
    judge.look(*host.cloth, now);
  }
  return judge.through();
}

/// The same in a process of its own. Bullet 3.24 writes beyond its arrays there
/// (btDeformableBackwardEulerObjective::multiply), which ends one process in a hundred. −1: five have ended,
/// or there is none.
int run_apart(const Case& c, double reach) {
  constexpr int attempts = 5;
  for (int k = 0; k < attempts; ++k) {
    int ends[2];
    if (pipe(ends) != 0) return -1;
    const pid_t child = fork();
    if (child == 0) {
      const int passed = run_theirs(c, reach);
      const bool is_written = write(ends[1], &passed, sizeof passed) == sizeof passed;
      _exit(is_written ? 0 : 1);
    }
    close(ends[1]);
    int passed = -1, status = 0;
    const bool is_read = child > 0 && read(ends[0], &passed, sizeof passed) == sizeof passed;
    close(ends[0]);
    if (child > 0) waitpid(child, &status, 0);
    if (is_read) return passed;
  }
  return -1;
}

/// Positions in order of id, which is the order in which particles were added.
std::vector<Vec3> positions_of(const oilskin::World& fluid) {
  std::vector<std::pair<std::uint64_t, Vec3>> by_id;
  for (std::size_t i = 0; i < fluid.particle_count(); ++i)
    by_id.emplace_back(fluid.ids()[i], fluid.positions()[i]);
  std::sort(by_id.begin(), by_id.end(), [](const auto& a, const auto& b) { return a.first < b.first; });
  std::vector<Vec3> x;
  x.reserve(by_id.size());
  for (const auto& [id, position] : by_id) x.push_back(position);
  return x;
}

int run_ours(const Case& c) {
  btSoftBodyRigidBodyCollisionConfiguration configuration;
  btCollisionDispatcher dispatcher(&configuration);
  btDbvtBroadphase broadphase;
  btSequentialImpulseConstraintSolver constraints;
  oilskin::bullet::btFluidSoftBodySolver solver;
  btSoftRigidDynamicsWorld world(&dispatcher, &broadphase, &constraints, &configuration, &solver);
  world.getWorldInfo().m_gravity = btVector3(0, 0, 0);
  const std::unique_ptr<btSoftBody> cloth(make_cloth(world.getWorldInfo()));
  world.addSoftBody(cloth.get());
  oilskin::FluidSettings settings;
  settings.spacing = 0.01;
  settings.max_substeps = 1;  // one straight path a step, as it is judged
  oilskin::bullet::btFluid fluid(settings, {}, {});
  std::vector<Vec3> x, v(particle_count, velocity_of(c.speed));
  for (std::size_t i = 0; i < particle_count; ++i) x.push_back(start_of(i));
  std::uint64_t blocked = 0;
  bool ok = solver.addFluid(&fluid).ok() && solver.addCloth(cloth.get(), bt(0.001)).ok() &&
            fluid.getWorld().add_particles(x, v, &blocked).ok() && blocked == 0;
  Judge judge(*cloth);
  for (int k = 0; ok && k < steps_of(c); ++k) {
    world.stepSimulation(bt(c.dt), 0);
    ok = fluid.getWorld().particle_count() == particle_count;
    if (ok) judge.look(*cloth, positions_of(fluid.getWorld()));
  }
  solver.removeCloth(cloth.get());
  world.removeSoftBody(cloth.get());
  return ok ? judge.through() : -1;
}

}  // namespace

int main(int argc, char** argv) {
  const bool quick = argc == 2 && std::strcmp(argv[1], "--quick") == 0;
  if (argc > 1 && !quick) {
    std::fprintf(stderr, "usage: bullet_ccd_compare [--quick]\n");
    return 2;
  }
  std::printf("%zu particles on a cloth; how many pass through it (Bullet %d.%02d, single precision)\n",
              particle_count, btGetVersion() / 100, btGetVersion() % 100);
  std::printf("%12s %10s %8s %15s %14s %15s\n", "speed [m/s]", "dt [ms]", "none", "Bullet, 10 mm",
              "Bullet, 1 mm", "Oilskin, 1 mm");
  int ours_in_all = 0;
  for (const double speed : quick ? std::vector<double>{5, 50} : std::vector<double>{1, 5, 20, 50, 200})
    for (const double dt :
         quick ? std::vector<double>{1. / 240} : std::vector<double>{1. / 60, 1. / 240, 0.001}) {
      const Case c{speed, dt};
      const int ours = run_ours(c);
      std::printf("%12g %10.3g %8d %15d %14d %15d\n", speed, 1000 * dt, run_without_contact(c),
                  run_apart(c, 0.01), run_apart(c, 0.001), ours);
      std::fflush(stdout);
      if (ours < 0) std::printf("Oilskin lost particles, or refused them\n");
      ours_in_all += std::abs(ours);
    }
  return ours_in_all == 0 ? 0 : 1;
}
