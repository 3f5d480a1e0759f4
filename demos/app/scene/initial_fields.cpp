#include "scene/initial_fields.h"

namespace oilskin::demo {
namespace {

VectorField make(const FieldTerm& t) {
  switch (t.kind) {
    case FieldKind::linear: {
      Eigen::Matrix3d gradient = Eigen::Matrix3d::Zero();
      for (std::size_t row = 0; row < t.gradient.size() && row < 3; ++row)
        gradient.row(static_cast<Eigen::Index>(row)) = t.gradient[row].transpose();
      return linear_field(t.origin, gradient);
    }
    case FieldKind::rotation:
      return rotation_field(t.origin, t.axis, t.rate);
    case FieldKind::taylor_green:
      return taylor_green_field(t.origin, t.edge_u, t.edge_v, t.amplitude);
    case FieldKind::standing_wave:
      break;
  }
  StandingWave wave = t.wave;
  wave.origin = t.origin;
  wave.amplitude = t.amplitude;
  return standing_wave_field(wave);
}

VectorField sum_of(const std::vector<FieldTerm>& terms) {
  if (terms.empty()) return {};
  std::vector<VectorField> fields;
  fields.reserve(terms.size());
  for (const FieldTerm& t : terms) fields.push_back(make(t));
  return [fields](const Vec3& x) {
    Vec3 sum = Vec3::Zero();
    for (const VectorField& f : fields) sum += f(x);
    return sum;
  };
}

}  // namespace

InitialState initial_state(const InitialFields& fields, std::uint64_t seed) {
  InitialState state;
  state.velocity = sum_of(fields.flow);
  state.displacement = sum_of(fields.displacement);
  state.shake = fields.shake;
  state.seed = seed;
  return state;
}

}  // namespace oilskin::demo
