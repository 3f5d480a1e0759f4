/// Which object of Bullet an attachment means.
#pragma once

#include <BulletCollision/CollisionDispatch/btCollisionObject.h>

#include <cstdint>

namespace oilskin::bullet {

/// A number in the extension pointer of an attached object. A new object at the address of a deleted one has
/// none, so it is not taken for the deleted one, which need not be read. The numbers are odd: an object whose
/// extension pointer another library uses keeps that pointer, and is known by its address only.
///
/// Couplings that share a static object share its number. Safe to use from several threads.
class ObjectMark {
 public:
  ObjectMark() = default;
  /// Forgets the number, and does not touch the object: it may have been deleted.
  ~ObjectMark();
  ObjectMark(const ObjectMark&) = delete;
  ObjectMark& operator=(const ObjectMark&) = delete;

  /// Is the object in a coupling now?
  static bool is_used(const btCollisionObject& object);

  /// Marks the object, once.
  void put_on(btCollisionObject& object);
  /// Takes the mark off an object that still exists, unless another coupling uses it.
  void take_off(btCollisionObject& object);
  /// Whether this is still the object that was marked.
  bool is_on(const btCollisionObject& object) const;

 private:
  std::uintptr_t number_ = 0;  // 0: none
};

}  // namespace oilskin::bullet
