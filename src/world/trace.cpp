#include "oilskin/trace.h"

#include <cstring>
#include <ostream>

#include "core/assert.h"

namespace oilskin {

namespace {

// The format is little endian without padding, as the supported machines are.
static_assert(sizeof(Vec3) == 24 && sizeof(Triangle) == 12);

template <class T>
void put(std::ostream& out, const T& value) {
  out.write(reinterpret_cast<const char*>(&value), sizeof value);
}

template <class T>
void put_all(std::ostream& out, Span<T> values) {
  out.write(reinterpret_cast<const char*>(values.data()),
            static_cast<std::streamsize>(values.size() * sizeof(T)));
}

}  // namespace

void TraceWriter::on_interval(const Interval& interval) {
  OILSKIN_ASSERT(interval.id.size() == interval.x_t0.size() && interval.id.size() == interval.x_t1.size());
  out_.write("OILSTEP1", 8);
  put(out_, interval.number);
  put(out_, interval.length);
  put(out_, static_cast<std::uint64_t>(interval.id.size()));
  put_all(out_, interval.id);
  put_all(out_, interval.x_t0);
  put_all(out_, interval.x_t1);
  put(out_, static_cast<std::uint64_t>(interval.surfaces.size()));
  for (const SurfaceMotion* s : interval.surfaces) {
    OILSKIN_ASSERT(s->id != 0 && s->x_t0.size() == s->x_t1.size());
    put(out_, s->id);
    put(out_, static_cast<std::uint64_t>(s->x_t0.size()));
    put(out_, static_cast<std::uint64_t>(s->triangles.size()));
    put_all(out_, Span<const Vec3>(s->x_t0));
    put_all(out_, Span<const Vec3>(s->x_t1));
    put_all(out_, Span<const Triangle>(s->triangles));
  }
}

}  // namespace oilskin
