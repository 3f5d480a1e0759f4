#include "ccd/queries.h"

#include <cmath>

namespace oilskin::test {
namespace {

Corners integers(Random& random, int size) {
  Corners x;
  for (Vec3& v : x) v = random.integer_vector(size);
  return x;
}

/// Moves every coordinate by up to two units in the last place.
Corners separated(Corners x, Random& random) {
  for (Vec3& v : x) {
    for (int k = 0; k < 3; ++k) {
      for (int i = random.integer(-2, 2); i != 0; i -= i > 0 ? 1 : -1)
        v[k] = std::nextafter(v[k], i > 0 ? 1e300 : -1e300);
    }
  }
  return x;
}

/// Weights of a point of the triangle: inside, on an edge, at a vertex, or just outside by `outside`.
Vec3 contact_weights(Random& random, double outside) {
  Vec3 w(random.uniform(0, 1), random.uniform(0, 1), random.uniform(0, 1));
  const int kind = random.integer(0, 3);
  const int k = random.integer(0, 2);
  if (kind == 1) w[k] = 0;
  if (kind == 2) w = Vec3::Unit(k);
  w /= w.sum();
  if (kind == 3) {
    w[(k + 1) % 3] += w[k] + outside;
    w[k] = -outside;
  }
  return w;
}

/// Places the point on the triangle at time t (up to rounding), with a velocity of its own.
void aim(Corners* x, Random& random, double speed, double outside) {
  const double t = random.integer(0, 3) == 0 ? random.integer(0, 8) / 8.0 : random.uniform(0, 1);
  const Vec3 w = contact_weights(random, outside);
  Vec3 meeting = Vec3::Zero();
  for (int i = 0; i < 3; ++i) meeting += w[i] * ((1 - t) * (*x)[1 + i] + t * (*x)[5 + i]);
  const Vec3 velocity = random.vector(speed);
  (*x)[0] = meeting - t * velocity;
  (*x)[4] = meeting + (1 - t) * velocity;
}

Corners constructed(Random& random, double size = 1, double speed = 1) {
  Corners x;
  for (int i = 1; i < 4; ++i) x[i] = random.vector(size);
  for (int i = 1; i < 4; ++i) x[4 + i] = x[i] + random.vector(speed);
  aim(&x, random, speed, std::abs(random.power_of_ten(-17, -2)));
  return x;
}

Corners translated(Corners x, const Vec3& offset) {
  for (Vec3& v : x) v += offset;
  return x;
}

Corners scaled(Corners x, double factor) {
  for (Vec3& v : x) v *= factor;
  return x;
}

/// The third corner almost on the line of the first two, at both ends.
Corners sliver(Random& random) {
  Corners x = constructed(random);
  for (int end = 0; end < 8; end += 4) {
    const double s = random.uniform(-0.5, 1.5), thickness = std::abs(random.power_of_ten(-16, -4));
    x[end + 3] = x[end + 1] + s * (x[end + 2] - x[end + 1]) + random.vector(thickness);
  }
  aim(&x, random, 1, std::abs(random.power_of_ten(-17, -2)));
  return x;
}

/// An integer affine map, which keeps contacts of integer or dyadic coordinates exact.
Corners mapped(const Corners& x, Random& random, int size) {
  const Vec3 a = random.integer_vector(size), b = random.integer_vector(size),
             c = random.integer_vector(size), d = random.integer_vector(size);
  Corners y;
  for (int i = 0; i < 8; ++i) y[i] = a * x[i][0] + b * x[i][1] + c * x[i][2] + d;
  return y;
}

/// Dips into the plane of a shearing triangle and out again: F = (t − ½)² times a constant.
Corners grazing(Random& random) {
  const Corners x{Vec3(.25, .75, .25), Vec3(0, 0, 0), Vec3(1, 0, 0), Vec3(0, 1, 0),
                  Vec3(.25, -.25, 0),  Vec3(0, 0, 0), Vec3(1, 0, 0), Vec3(0, 1, 1)};
  Corners y = mapped(x, random, 4);
  const int kind = random.integer(0, 3);
  if (kind == 1) y = separated(y, random);
  if (kind == 2) {  // just above or below: no root, or two close to each other
    const Vec3 shift = random.vector(1) * random.power_of_ten(-17, -3);
    y[0] += shift;
    y[4] += shift;
  }
  if (kind == 3) y = translated(y, random.vector(1e3));
  return y;
}

/// Everything in one plane: that of two axes, a skew one, or one that turns with time.
Corners coplanar(Random& random) {
  Corners x = integers(random, 3);
  for (Vec3& v : x) v[2] = 0;
  const int kind = random.integer(0, 2);
  if (kind == 0) return scaled(x, random.uniform(0.1, 1));
  Corners start = mapped(x, random, 3);
  if (kind == 1) return start;
  const Corners end = mapped(x, random, 3);
  for (int i = 4; i < 8; ++i) start[i] = end[i];
  return start;
}

/// Segments and points, of integers or rounded, hit or missed by little.
Corners degenerate(Random& random) {
  Corners x = random.integer(0, 1) == 0 ? integers(random, 3) : constructed(random);
  const int kind = random.integer(0, 3);
  for (int end = 0; end < 8; end += 4) {
    if (kind == 0) x[end + 3] = x[end + 2];
    if (kind == 1) x[end + 2] = x[end + 3] = x[end + 1];
    if (kind == 2) x[end + 3] = 2 * x[end + 2] - x[end + 1];
    if (kind == 3 && end == 0) x[end + 3] = x[end + 2];  // a segment that opens
  }
  if (random.integer(0, 1) == 0) aim(&x, random, 1, std::abs(random.power_of_ten(-17, -2)));
  return x;
}

/// Contact at dyadic time and weights with integers: exactly touching, without any rounding.
Corners dyadic_contact(Random& random) {
  Corners x = integers(random, 8);
  const int n = 1 << random.integer(0, 4), j = random.integer(0, n), m = 1 << random.integer(0, 4);
  const double t = static_cast<double>(j) / n;
  const int wa = random.integer(0, m), wb = random.integer(0, m - wa);
  const Vec3 w = Vec3(wa, wb, m - wa - wb) / m;
  Vec3 meeting = Vec3::Zero();
  for (int i = 0; i < 3; ++i) meeting += w[i] * ((1 - t) * x[1 + i] + t * x[5 + i]);
  const Vec3 velocity = random.integer_vector(8);
  x[0] = meeting - t * velocity;
  x[4] = meeting + (1 - t) * velocity;
  return random.integer(0, 2) == 0 ? separated(x, random) : x;
}

/// A point that lies on a sheet with a tiny gap and slides, perhaps over an edge.
Corners resting(Random& random) {
  const double gap = random.power_of_ten(-18, -3), slide = random.power_of_ten(-12, 0);
  Corners x{Vec3(random.uniform(-.1, .6), random.uniform(-.1, .6), gap), Vec3(0, 0, 0), Vec3(1, 0, 0),
            Vec3(0, 1, 0)};
  for (int i = 0; i < 4; ++i) x[4 + i] = x[i] + Vec3(0, 0, random.uniform(-1, 1)) * 0.5 * gap;
  x[4] += Vec3(random.uniform(-1, 1), random.uniform(-1, 1), 0) * slide;
  if (random.integer(0, 1) == 0) return x;
  return translated(scaled(x, 0.01), random.vector(1));
}

/// Integers at the bottom of the range of doubles.
Corners denormal(Random& random) {
  const Corners x = random.integer(0, 1) == 0 ? dyadic_contact(random) : integers(random, 2);
  return scaled(x, std::ldexp(1.0, -random.integer(1010, 1074)));
}

/// A triple root: corners are combinations of the rows of (τ 1 0, 0 τ 1, 0 0 τ), so that f = τ³ times a
/// constant, with τ from −1 to 1 or 2.
Corners triple_root(Random& random) {
  const double end = random.integer(1, 2);
  const auto row = [](int i, double tau) {
    Vec3 r = tau * Vec3::Unit(i);
    if (i < 2) r[i + 1] = 1;
    return r;
  };
  Corners x{random.integer_vector(2), {}, {}, {}, random.integer_vector(2), {}, {}, {}};
  for (int i = 1; i < 4; ++i) {
    const Vec3 w = random.integer_vector(3);
    x[i] = x[0] + w[0] * row(0, -1) + w[1] * row(1, -1) + w[2] * row(2, -1);
    x[4 + i] = x[4] + w[0] * row(0, end) + w[1] * row(1, end) + w[2] * row(2, end);
  }
  const int kind = random.integer(0, 3);
  if (kind == 1) return separated(x, random);
  if (kind == 2) return translated(scaled(x, random.uniform(0.1, 1)), random.vector(1e3));
  if (kind == 3) x[random.integer(0, 7)] += random.vector(1) * random.power_of_ten(-17, 0);
  return x;
}

/// Points that slide along an edge, or just beside it, in a plane of integer or skew directions.
Corners along_an_edge(Random& random) {
  const bool integral = random.integer(0, 1) == 0;
  const auto any = [&] { return integral ? random.integer_vector(4) : random.vector(1); };
  Corners x{any(), any(), any(), any()};
  for (int i = 0; i < 4; ++i) x[4 + i] = x[i] + any();
  const double from = random.integer(-2, 6) / 4.0, to = random.integer(-2, 6) / 4.0;
  x[0] = x[1] + from * (x[2] - x[1]);
  x[4] = x[5] + to * (x[6] - x[5]);
  const int kind = random.integer(0, 2);
  if (kind == 1) return separated(x, random);
  if (kind == 2) {
    const double gap = random.power_of_ten(-20, -8);
    x[0] += gap * any();
    x[4] += gap * any();
  }
  return x;
}

/// Coordinates of very different sizes in one query.
Corners mixed_sizes(Random& random) {
  Corners x;
  for (Vec3& v : x) {
    for (int k = 0; k < 3; ++k) v[k] = random.integer(0, 3) == 0 ? 0 : random.power_of_ten(-250, 60);
  }
  if (random.integer(0, 1) == 0) aim(&x, random, 1, 0);
  return x;
}

Corners scaled_by_power_of_two(Random& random) {
  const Corners x = random.integer(0, 1) == 0 ? constructed(random) : dyadic_contact(random);
  return scaled(x, std::ldexp(1.0, random.integer(0, 1) == 0 ? 20 : -20));
}

}  // namespace

ccd::PointTriangleMotion to_motion(const Corners& x) {
  return {x[0], x[1], x[2], x[3], x[4], x[5], x[6], x[7]};
}

exact::Motion to_exact(const Corners& x) {
  exact::Motion motion;
  for (int i = 0; i < 4; ++i) {
    motion.t0[i] = {x[i][0], x[i][1], x[i][2]};
    motion.t1[i] = {x[4 + i][0], x[4 + i][1], x[4 + i][2]};
  }
  return motion;
}

double Random::uniform(double low, double high) {
  return low + (high - low) * (static_cast<double>(engine_() >> 11) * 0x1p-53);
}

int Random::integer(int low, int high) {
  return low + static_cast<int>(engine_() % static_cast<std::uint64_t>(high - low + 1));
}

Vec3 Random::vector(double size) {
  const double x = uniform(-size, size), y = uniform(-size, size), z = uniform(-size, size);
  return {x, y, z};
}

Vec3 Random::integer_vector(int size) {
  const int x = integer(-size, size), y = integer(-size, size), z = integer(-size, size);
  return {static_cast<double>(x), static_cast<double>(y), static_cast<double>(z)};
}

double Random::power_of_ten(double low, double high) {
  const double magnitude = std::pow(10, uniform(low, high));
  return integer(0, 1) == 0 ? magnitude : -magnitude;
}

const std::vector<Family>& families() {
  static const std::vector<Family> all{
      {"random", [](Random& r) { return constructed(r, 1, r.uniform(0, 2)); }},
      {"small integers", [](Random& r) { return integers(r, r.integer(1, 3)); }},
      {"small integers and ulps", [](Random& r) { return separated(integers(r, 2), r); }},
      {"constructed contact", [](Random& r) { return constructed(r); }},
      {"constructed contact and ulps", [](Random& r) { return separated(constructed(r), r); }},
      {"dyadic contact", dyadic_contact},
      {"offset", [](Random& r) { return translated(constructed(r), r.vector(r.power_of_ten(0, 6))); }},
      {"small and offset",
       [](Random& r) { return translated(constructed(r, 1e-3, 1e-3), r.vector(r.power_of_ten(0, 6))); }},
      {"sliver", sliver},
      {"double root", grazing},
      {"along an edge", along_an_edge},
      {"triple root", triple_root},
      {"coplanar", coplanar},
      {"coplanar and ulps", [](Random& r) { return separated(coplanar(r), r); }},
      {"fast", [](Random& r) { return constructed(r, 1, std::abs(r.power_of_ten(2, 6))); }},
      {"slow", [](Random& r) { return constructed(r, 1, std::abs(r.power_of_ten(-14, -2))); }},
      {"segments and points", degenerate},
      {"segments and points and ulps", [](Random& r) { return separated(degenerate(r), r); }},
      {"resting", resting},
      {"scaled by 2^±20", scaled_by_power_of_two},
      {"denormal", denormal},
      {"tiny", [](Random& r) { return scaled(constructed(r), std::abs(r.power_of_ten(-300, -90))); }},
      {"huge", [](Random& r) { return scaled(constructed(r), std::abs(r.power_of_ten(60, 89))); }},
      {"mixed sizes", mixed_sizes, true},
  };
  return all;
}

}  // namespace oilskin::test
