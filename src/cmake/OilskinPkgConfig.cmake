# Files for pkg-config. Their prefix follows from where they lie, so an installed copy may be moved.

if(IS_ABSOLUTE ${CMAKE_INSTALL_LIBDIR})
  set(oilskin_pc_prefix ${CMAKE_INSTALL_PREFIX})
  set(oilskin_pc_libdir ${CMAKE_INSTALL_LIBDIR})
else()
  file(RELATIVE_PATH oilskin_pc_prefix /${CMAKE_INSTALL_LIBDIR}/pkgconfig /)
  string(REGEX REPLACE "/$" "" oilskin_pc_prefix "\${pcfiledir}/${oilskin_pc_prefix}")
  set(oilskin_pc_libdir "\${prefix}/${CMAKE_INSTALL_LIBDIR}")
endif()
if(IS_ABSOLUTE ${CMAKE_INSTALL_INCLUDEDIR})
  set(oilskin_pc_includedir ${CMAKE_INSTALL_INCLUDEDIR})
else()
  set(oilskin_pc_includedir "\${prefix}/${CMAKE_INSTALL_INCLUDEDIR}")
endif()

# oilskin_install_pc(name description requires cflags libs)
function(oilskin_install_pc name description requires cflags libs)
  set(oilskin_pc_text "prefix=${oilskin_pc_prefix}
libdir=${oilskin_pc_libdir}
includedir=${oilskin_pc_includedir}

Name: ${name}
Description: ${description}
URL: ${PROJECT_HOMEPAGE_URL}
Version: ${PROJECT_VERSION}
Requires: ${requires}
Cflags: -I\${includedir}${cflags}
Libs: -L\${libdir} ${libs}
")
  string(REPLACE "URL: \n" "" oilskin_pc_text "${oilskin_pc_text}")
  # Once per configuration of a generator with several; the text is the same.
  file(GENERATE OUTPUT ${PROJECT_BINARY_DIR}/${name}.pc CONTENT "${oilskin_pc_text}")
  install(FILES ${PROJECT_BINARY_DIR}/${name}.pc DESTINATION ${CMAKE_INSTALL_LIBDIR}/pkgconfig COMPONENT development)
endfunction()

# FCL and oneTBB as plain libraries: fcl.pc passes on -std=c++11. Their own dependencies are not named, so they must be
# shared libraries. Found again: the targets that src found are visible there alone.
find_package(fcl 0.7 REQUIRED CONFIG)
set(libraries "-loilskin -L$<TARGET_FILE_DIR:fcl> -lfcl")
if(OILSKIN_TBB)
  find_package(TBB REQUIRED)
  string(APPEND libraries " -L$<TARGET_FILE_DIR:TBB::tbb> -ltbb")
endif()
oilskin_install_pc(oilskin "${PROJECT_DESCRIPTION}" "eigen3 >= 3.4"
                   " -DEIGEN_MAX_ALIGN_BYTES=${OILSKIN_EIGEN_ALIGNMENT}" "${libraries}")
if(TARGET oilskin_reconstruction)
  oilskin_install_pc(oilskin-reconstruction "The mesh of Oilskin's water" "oilskin = ${PROJECT_VERSION}" "" "-loilskin_reconstruction")
endif()

# Not for Bullets that pkg-config does not know: how to link those, only their project knows.
if(TARGET oilskin_bullet AND oilskin_bullet_module)
  oilskin_install_pc(oilskin-bullet "Oilskin for Bullet of single precision" "oilskin = ${PROJECT_VERSION}, bullet >= 3.24" ""
                     "-loilskin_bullet")
endif()
if(TARGET oilskin_bullet_f64 AND oilskin_bullet_f64_module)
  oilskin_install_pc(oilskin-bullet-f64 "Oilskin for Bullet of double precision"
                     "oilskin = ${PROJECT_VERSION}, bullet-float64 >= 3.24" " -DBT_USE_DOUBLE_PRECISION" "-loilskin_bullet_f64")
endif()
