#include <algorithm>

#include "coupling_impl.h"

namespace oilskin::bullet {

namespace {

/// In btSoftBody::applyForces().
bool reads_normals(const btSoftBody& body) {
  return body.m_cfg.kDP != 0 || body.m_cfg.kLF != 0 || body.m_cfg.kPR != 0 || body.m_cfg.kVC != 0;
}

}  // namespace

btFluidSoftBodySolver::btFluidSoftBodySolver() = default;
btFluidSoftBodySolver::~btFluidSoftBodySolver() = default;

void btFluidSoftBodySolver::setCouplingInterval(int n) {
  btAssert(n >= 1);
  m_interval = std::max(1, n);
}

const StepReport& btFluidSoftBodySolver::getReport() const {
  return m_coupling.getReport();
}

void btFluidSoftBodySolver::optimize(btAlignedObjectArray<btSoftBody*>& softBodies, bool forceUpdate) {
  m_coupling.detachAbsent(softBodies);
  btDefaultSoftBodySolver::optimize(softBodies, forceUpdate);
}

/// The only call with the length of a sub-step. Bullet passes it as a float in both precisions, and advances
/// its soft bodies by that.
void btFluidSoftBodySolver::predictMotion(btScalar solverdt) {
  m_coupling.m_impl->pending_time += static_cast<double>(solverdt);
  btDefaultSoftBodySolver::predictMotion(solverdt);
}

/// The last call of a sub-step: links, contacts and self-collision are solved, normals are not updated yet.
/// Bullet does not overwrite what is written from here on.
void btFluidSoftBodySolver::updateSoftBodies() {
  int& pending = m_coupling.m_impl->pending;
  double& pending_time = m_coupling.m_impl->pending_time;
  ++pending;
  if (pending >= m_interval && pending_time > 0) {
    if (m_coupling.getFluid()) m_coupling.couple(pending_time, /*updateNormals=*/false);
    pending = 0;
    pending_time = 0;
  }
  if (m_updatesNormals) {
    btDefaultSoftBodySolver::updateSoftBodies();
  } else {
    for (int i = 0; i < m_softBodySet.size(); ++i)
      if (m_softBodySet[i]->isActive() && reads_normals(*m_softBodySet[i]))
        m_softBodySet[i]->integrateMotion();
  }
  m_coupling.tellListeners();  // Bullet reads no soft body after this
}

}  // namespace oilskin::bullet
