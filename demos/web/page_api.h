/// The functions that a page calls, in C: one scene at a time. Those that return int give 1 where they did
/// what was asked, and 0 where they refused; page_message() then says why, and the scene is as before.
/// Pointers that they return are valid until the next call.
#pragma once

#include <stdint.h>  // NOLINT(modernize-deprecated-headers): C

#if defined(__EMSCRIPTEN__)
#define OILSKIN_PAGE_CALL __attribute__((used, visibility("default")))
#else
#define OILSKIN_PAGE_CALL
#endif

extern "C" {

/// Opens a scene in place of the one before. `settings`: assignments KEY=VALUE, one per line.
OILSKIN_PAGE_CALL int page_open(const char* scene, const char* settings);
/// Makes `count` steps.
OILSKIN_PAGE_CALL int page_step(int count);
/// Switches the continuous test and impact zones from the next step on: 1 = on, 0 = off.
OILSKIN_PAGE_CALL int page_set_contact(int on);
/// Takes hold of the cloth where it is nearest to a point [m].
OILSKIN_PAGE_CALL int page_grab(double x, double y, double z);
/// Where what is held is to be [m].
OILSKIN_PAGE_CALL int page_pull(double x, double y, double z);
/// Lets go of what is held.
OILSKIN_PAGE_CALL int page_release();
/// Turns the first nozzle to a direction.
OILSKIN_PAGE_CALL int page_aim(double x, double y, double z);
/// How many steps the scene has made; 0 without a scene.
OILSKIN_PAGE_CALL int page_steps();
/// Why the last call was refused; empty if it was not.
OILSKIN_PAGE_CALL const char* page_message();

// Those below need a scene.
/// PageScene::report()
OILSKIN_PAGE_CALL const char* page_report();
/// PageScene::description()
OILSKIN_PAGE_CALL const char* page_description();
/// World::state_hash() as 0x and 16 hexadecimal digits.
OILSKIN_PAGE_CALL const char* page_state_hash();
/// Four numbers per particle: position [m], speed [m/s]; `count` is the number of particles.
OILSKIN_PAGE_CALL const float* page_particles(uint32_t* count);
/// Three numbers per node of the cloth: position [m]; `count` is the number of nodes.
OILSKIN_PAGE_CALL const float* page_nodes(uint32_t* count);
/// Three nodes per triangle of the cloth; `count` is the number of triangles.
OILSKIN_PAGE_CALL const uint32_t* page_triangles(uint32_t* count);

}  // extern "C"
