#include "scene/body_format.h"

#include "scene/emitter_format.h"
#include "scene/surface_format.h"

namespace oilskin::demo {
namespace {

enum class BodyShape { box, sphere, plane, mesh, tank, compound };

void describe(Fields& f, TankShape& t) {
  f.vec3("min", t.inside.min);
  f.vec3("max", t.inside.max);
  if (f.reading() && !(t.inside.min.array() < t.inside.max.array()).all())
    f.fail("max", "must exceed min in every coordinate");
  f.vec3("open", t.open);
  if (f.reading() && (t.open.array() != 0).count() > 1)
    f.fail("open", "must be along x, y or z, or [0, 0, 0] for a closed box");
  f.quaternion("rotate", t.rotate);
}

void describe(Fields& f, BoxShape& box) {
  f.vec3("center", box.center);
  f.vec3("half_extents", box.half_extents);
  f.quaternion("rotate", box.rotate);
  if (f.reading() && !(box.half_extents.array() > 0).all()) f.fail("half_extents", "must be > 0 each");
}

/// What has no volume, or a motion of its own, cannot be moved by the water.
void check_dynamic(Fields& f, const Body& b) {
  if (!b.is_dynamic()) return;
  const char* key = b.mass > 0 ? "mass" : "density";
  if (b.mass > 0 && b.density > 0) f.fail("density", "is given beside \"mass\": give one of them");
  if (b.motion.moves()) f.fail(key, "makes the water move the body, which has a \"motion\" of its own");
  if (std::holds_alternative<PlaneShape>(b.shape) || std::holds_alternative<TankShape>(b.shape))
    f.fail(key, "needs a body with a volume: box, sphere, mesh or compound");
}

void describe_shape(Fields& f, Body& b) {
  auto shape = static_cast<BodyShape>(b.shape.index());
  f.choice("shape", shape,
           {{"box", BodyShape::box},
            {"sphere", BodyShape::sphere},
            {"plane", BodyShape::plane},
            {"mesh", BodyShape::mesh},
            {"tank", BodyShape::tank},
            {"compound", BodyShape::compound}});
  if (f.reading() && !f.has("shape"))
    f.fail("shape", "is missing: box, sphere, plane, mesh, tank or compound");
  switch (shape) {
    case BodyShape::box:
      if (f.reading()) b.shape = BoxShape();
      describe(f, std::get<BoxShape>(b.shape));
      break;
    case BodyShape::sphere: {
      if (f.reading()) b.shape = SphereShape();
      auto& sphere = std::get<SphereShape>(b.shape);
      f.vec3("center", sphere.center);
      f.number("radius", sphere.radius, positive());
      break;
    }
    case BodyShape::plane: {
      if (f.reading()) b.shape = PlaneShape();
      auto& plane = std::get<PlaneShape>(b.shape);
      f.vec3("point", plane.point);
      f.direction("normal", plane.normal);
      break;
    }
    case BodyShape::mesh:
      if (f.reading()) b.shape = PlacedMesh();
      describe(f, std::get<PlacedMesh>(b.shape));
      break;
    case BodyShape::tank:
      if (f.reading()) b.shape = TankShape();
      describe(f, std::get<TankShape>(b.shape));
      break;
    case BodyShape::compound: {
      if (f.reading()) b.shape = CompoundShape();
      auto& compound = std::get<CompoundShape>(b.shape);
      f.list("boxes", compound.boxes, [](Fields& g, BoxShape& box) { describe(g, box); });
      if (f.reading() && compound.boxes.empty()) f.fail("boxes", "is empty, must have a box or more");
      break;
    }
  }
}

}  // namespace

void describe(Fields& f, Body& b) {
  describe_shape(f, b);
  f.number("mass", b.mass, not_negative());
  f.number("density", b.density, not_negative());
  f.object("motion", [&](Fields& g) { describe(g, b.motion); });
  if (f.reading()) check_dynamic(f, b);
  describe(f, b.surface);
}

}  // namespace oilskin::demo
