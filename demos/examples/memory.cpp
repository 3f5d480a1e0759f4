// All memory of the water from the game's allocator, counted, within a budget. The program replaces operator
// new.
#include <atomic>
#include <cstdio>
#include <new>
#include <thread>

#include "oilskin/bullet.h"
#include "oilskin/job_system.h"

namespace {

/// Who asks for memory on this thread.
enum Owner : std::size_t { game, water_of_game };
thread_local Owner owner = game;

std::atomic<std::size_t> used[2];  // [bytes]
std::atomic<std::size_t> budget_of_water{std::size_t(-1)};

/// Before each block. As large as the alignment that operator new promises.
struct alignas(__STDCPP_DEFAULT_NEW_ALIGNMENT__) Header {
  std::size_t size;
  Owner owner;
};

/// From Bullet's allocator, which btAlignedAllocSetCustom() may have replaced. Null: not within the budget.
void* allocate(std::size_t size) noexcept {
  if (owner == water_of_game && used[owner] + size > budget_of_water) return nullptr;
  void* const memory = btAlignedAlloc(sizeof(Header) + size, alignof(Header));
  if (memory == nullptr) return nullptr;
  used[owner] += size;
  return new (memory) Header{size, owner} + 1;
}

void release(void* block) noexcept {
  if (block == nullptr) return;
  Header* const header = static_cast<Header*>(block) - 1;
  used[header->owner] -= header->size;
  btAlignedFree(header);
}

void* allocate_or_throw(std::size_t size) {
  if (void* block = allocate(size)) return block;
  throw std::bad_alloc();
}

}  // namespace

void* operator new(std::size_t size) {
  return allocate_or_throw(size);
}
void* operator new[](std::size_t size) {
  return allocate_or_throw(size);
}
void* operator new(std::size_t size, const std::nothrow_t&) noexcept {
  return allocate(size);
}
void* operator new[](std::size_t size, const std::nothrow_t&) noexcept {
  return allocate(size);
}
void operator delete(void* block) noexcept {
  release(block);
}
void operator delete[](void* block) noexcept {
  release(block);
}
void operator delete(void* block, std::size_t) noexcept {
  release(block);
}
void operator delete[](void* block, std::size_t) noexcept {
  release(block);
}

namespace {

/// While it lives, what this thread allocates is that owner's.
class OwnerScope {
 public:
  explicit OwnerScope(Owner now) : before_(owner) { owner = now; }
  ~OwnerScope() { owner = before_; }
  OwnerScope(const OwnerScope&) = delete;
  OwnerScope& operator=(const OwnerScope&) = delete;

 private:
  Owner before_;
};

/// Gives the owner to the threads that help. A game has a pool of threads here.
class Jobs : public oilskin::JobSystem {
 public:
  int threads() const override { return 2; }
  void run(int count, const oilskin::LoopTasks& tasks) override {
    std::thread helper([&, of_caller = owner] {
      const OwnerScope scope(of_caller);
      tasks(0, count / 2);
    });
    tasks(count / 2, count);
    helper.join();
  }
};

bool accepted(const oilskin::Status& status) {
  if (!status.ok()) std::fprintf(stderr, "refused: %s\n", status.message.c_str());
  return status.ok();
}

bool run_game() {
  btBoxShape tableShape(btVector3(btScalar(0.3), btScalar(0.02), btScalar(0.3)));
  btCollisionObject table;  // its top is at y = 0.02
  table.setCollisionShape(&tableShape);
  bool ok = true;
  int refused = 0;
  {
    const OwnerScope scope(water_of_game);
    oilskin::bullet::btFluid water(btScalar(0.01));  // rest distance of the particles [m]
    oilskin::bullet::btFluidCoupling coupling(&water);
    ok = accepted(coupling.addCollisionObject(&table, btScalar(0.002))) &&
         accepted(water.addBox({btScalar(-0.1), btScalar(0.03), btScalar(-0.1)},
                               {btScalar(0.1), btScalar(0.13), btScalar(0.1)}));
    for (int step = 0; step < 40; ++step) {
      if (step == 20) budget_of_water = used[water_of_game] + 1000;
      try {
        coupling.step(btScalar(0.002));
      } catch (const std::bad_alloc&) {  // the water is as it was before the step
        ++refused;
        budget_of_water = std::size_t(-1);
      }
    }
    std::printf("%d particles in %.1f MB\n", water.getNumParticles(), double(used[water_of_game]) * 1e-6);
    ok = ok && water.getNumParticles() == 4000;
  }
  std::printf("steps beyond the budget: %d; without water it has %zu bytes\n", refused,
              used[water_of_game].load());
  return ok && refused == 1 && used[water_of_game] < 1000;  // a table of the adapter stays
}

}  // namespace

int main() {
  Jobs jobs;
  const bool ok = accepted(oilskin::set_job_system(&jobs)) && run_game();
  static_cast<void>(oilskin::set_job_system(nullptr));
  return ok ? 0 : 1;
}
