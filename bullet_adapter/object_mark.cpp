#include "object_mark.h"

#include <mutex>
#include <unordered_map>

namespace oilskin::bullet {

namespace {

/// The numbers in use with the couplings that use them. A number is not used twice.
struct Numbers {
  std::mutex mutex;
  std::unordered_map<std::uintptr_t, int> users;
  std::uintptr_t next = 1;
};

/// Is never destroyed: couplings with static storage duration may outlive every other static object.
Numbers& numbers() {
  static auto* const all = new Numbers;
  return *all;
}

std::uintptr_t number_of(const btCollisionObject& object) {
  return reinterpret_cast<std::uintptr_t>(object.internalGetExtensionPointer());
}

void set_number(btCollisionObject& object, std::uintptr_t number) {
  object.internalSetExtensionPointer(reinterpret_cast<void*>(number));
}

/// How many couplings are left.
int drop_user(std::uintptr_t number) {
  Numbers& all = numbers();
  const std::lock_guard<std::mutex> lock(all.mutex);
  const auto it = all.users.find(number);
  if (it == all.users.end()) return 0;
  if (--it->second > 0) return it->second;
  all.users.erase(it);
  return 0;
}

}  // namespace

ObjectMark::~ObjectMark() {
  if (number_) drop_user(number_);
}

bool ObjectMark::is_used(const btCollisionObject& object) {
  Numbers& all = numbers();
  const std::lock_guard<std::mutex> lock(all.mutex);
  return all.users.count(number_of(object)) > 0;
}

void ObjectMark::put_on(btCollisionObject& object) {
  Numbers& all = numbers();
  const std::lock_guard<std::mutex> lock(all.mutex);
  const std::uintptr_t present = number_of(object);
  const bool is_foreign = present != 0 && present % 2 == 0;
  if (number_ || is_foreign) return;
  const auto it = all.users.find(present);
  if (it != all.users.end()) {
    number_ = present;
    ++it->second;
    return;
  }
  // An odd number that nobody uses is left from a coupling that was deleted before the object.
  number_ = all.next;
  all.next += 2;
  all.users[number_] = 1;
  set_number(object, number_);
}

void ObjectMark::take_off(btCollisionObject& object) {
  if (!number_) return;
  if (drop_user(number_) == 0 && number_of(object) == number_) set_number(object, 0);
  number_ = 0;
}

bool ObjectMark::is_on(const btCollisionObject& object) const {
  return number_ == 0 || number_of(object) == number_;
}

}  // namespace oilskin::bullet
