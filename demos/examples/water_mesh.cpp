// The water as a closed triangle mesh, in every frame, that does not cut the cloth: water_NN.obj in the
// folder that is named on the command line (default: here).
#include <BulletSoftBody/btSoftBodyHelpers.h>
#include <BulletSoftBody/btSoftBodyRigidBodyCollisionConfiguration.h>
#include <BulletSoftBody/btSoftRigidDynamicsWorld.h>

#include <algorithm>
#include <cstdio>
#include <fstream>

#include "oilskin/bullet.h"
#include "oilskin/reconstruction.h"

static bool accepted(const oilskin::Status& status) {
  if (!status.ok()) std::fprintf(stderr, "refused: %s\n", status.message.c_str());
  return status.ok();
}

static bool write_obj(const std::string& path, const oilskin::WaterMesh& mesh) {
  std::ofstream out(path);
  for (const auto& x : mesh.positions) out << "v " << x[0] << ' ' << x[1] << ' ' << x[2] << '\n';
  for (const auto& t : mesh.triangles) out << "f " << t[0] + 1 << ' ' << t[1] + 1 << ' ' << t[2] + 1 << '\n';
  return bool(out.flush());
}

int main(int argc, char** argv) {
  btSoftBodyRigidBodyCollisionConfiguration configuration;
  btCollisionDispatcher dispatcher(&configuration);
  btDbvtBroadphase broadphase;
  btSequentialImpulseConstraintSolver constraints;
  oilskin::bullet::btFluidSoftBodySolver softSolver;
  btSoftRigidDynamicsWorld world(&dispatcher, &broadphase, &constraints, &configuration, &softSolver);
  world.getWorldInfo().m_gravity = btVector3(0, btScalar(-9.81), 0);

  const btScalar r = btScalar(0.15), spacing = btScalar(0.01);  // [m]
  btSoftBody* cloth = btSoftBodyHelpers::CreatePatch(world.getWorldInfo(), {-r, 0, -r}, {r, 0, -r},
                                                     {-r, 0, r}, {r, 0, r}, 21, 21, 1 + 2 + 4 + 8, true);
  cloth->setTotalMass(btScalar(0.03));
  cloth->getCollisionShape()->setMargin(btScalar(0.005));
  world.addSoftBody(cloth);
  oilskin::bullet::btFluid water(spacing);
  if (!accepted(softSolver.addFluid(&water)) || !accepted(softSolver.addCloth(cloth, btScalar(0.001))) ||
      !accepted(water.addJet({0, btScalar(0.1), 0}, {0, -1, 0}, btScalar(1.5), btScalar(0.03))))
    return 1;

  oilskin::ReconstructionOptions options;
  options.spacing = double(spacing);
  options.gap = 0.0005;  // between water and cloth [m]
  options.smoothing_iterations = 10;
  oilskin::EllipsoidOptions splats;  // for renderers without a mesh
  splats.spacing = options.spacing;
  splats.gap = options.gap;
  oilskin::WaterMesher mesher;
  oilskin::WaterMesh mesh;
  std::vector<oilskin::WaterEllipsoid> ellipsoids;
  bool good = true;
  for (int frame = 0; frame < 10; ++frame) {
    world.stepSimulation(btScalar(1. / 60), 20, btScalar(0.001));
    const oilskin::SurfaceMotion& sheet = *softSolver.getCoupling().getSurface(cloth);
    oilskin::ReconstructionInput input;
    input.positions = water.getWorld().positions();
    input.obstacles.push_back({sheet.x_t1, sheet.triangles});
    if (!accepted(mesher.reconstruct(input, options, &mesh)) ||
        !accepted(make_ellipsoids(input, splats, &ellipsoids)))
      return 1;

    const std::string path =
        std::string(argc > 1 ? argv[1] : ".") + "/water_0" + std::to_string(frame) + ".obj";
    const oilskin::MeshCheck check = check_mesh(mesh, input.obstacles, options.gap);
    const auto drawn = std::count_if(ellipsoids.begin(), ellipsoids.end(),
                                     [](const oilskin::WaterEllipsoid& e) { return e.radii[0] > 0; });
    std::printf("%s: %zu triangles, %.3g litres, %zu of them cut the cloth; or %d ellipsoids\n", path.c_str(),
                mesh.triangles.size(), 1000 * check.volume, check.intersecting_pairs, int(drawn));
    good = good && check.clean() && check.volume > 0 && write_obj(path, mesh);
  }

  softSolver.removeCloth(cloth);
  world.removeSoftBody(cloth);
  delete cloth;
  return good ? 0 : 1;
}
