/// Archive for Bullet's types. Numbers that are not finite are refused when they are written, too.
#pragma once

#include <LinearMath/btTransform.h>

#include <cmath>

#include "core/archive.h"

namespace oilskin::bullet {

inline void visit(Archive& archive, btScalar& x) {
  archive.value(x);
  if (!std::isfinite(x)) archive.refuse("a number of Bullet's is not finite");
}
inline void visit(Archive& archive, int& x) {
  archive.value(x);
}
inline void visit(Archive& archive, bool& x) {
  archive.value(x);
}
inline void visit(Archive& archive, btVector3& v) {
  for (int i = 0; i < 3; ++i) visit(archive, v.m_floats[i]);
  if (archive.reading()) v.m_floats[3] = 0;
}
inline void visit(Archive& archive, btMatrix3x3& m) {
  for (int row = 0; row < 3; ++row) visit(archive, m[row]);
}
inline void visit(Archive& archive, btTransform& t) {
  visit(archive, t.getBasis());
  visit(archive, t.getOrigin());
}
inline void visit(Archive& archive, std::string& text) {
  std::vector<char> letters(text.begin(), text.end());
  archive.value(letters);
  text.assign(letters.begin(), letters.end());
}
inline void visit(Archive& archive, std::vector<std::string>& texts) {
  archive.list(texts, sizeof(std::uint64_t), [&](std::string& text) { visit(archive, text); });
}

}  // namespace oilskin::bullet
