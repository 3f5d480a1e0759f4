# page_bullet: those libraries of Bullet that the adapter needs, single precision, as plain C++.
file(GLOB bullet_root ${OILSKIN_PAGE_SOURCES}/bullet-*/src)
list(LENGTH bullet_root found)
if(NOT found EQUAL 1)
  message(FATAL_ERROR "OILSKIN_PAGE_SOURCES (${OILSKIN_PAGE_SOURCES}) must hold one folder bullet-*, not ${found}")
endif()
file(GLOB_RECURSE bullet_sources ${bullet_root}/LinearMath/*.cpp ${bullet_root}/BulletCollision/*.cpp
     ${bullet_root}/BulletDynamics/*.cpp ${bullet_root}/BulletSoftBody/*.cpp)
add_library(page_bullet STATIC ${bullet_sources})
target_include_directories(page_bullet SYSTEM PUBLIC ${bullet_root})
target_compile_options(page_bullet PRIVATE -ffp-contract=off -w)
