# cmake --install: libraries, public headers, a package for find_package(oilskin [COMPONENTS bullet bullet_f64]) and files
# for pkg-config (oilskin, oilskin-reconstruction, oilskin-bullet, oilskin-bullet-f64).
# The component `development` is these alone, without the programs.
include(GNUInstallDirs)
include(CMakePackageConfigHelpers)

set(oilskin_package_dir ${CMAKE_INSTALL_LIBDIR}/cmake/oilskin)

# oilskin_install_library(export_set target headers): the folder `headers` lands in the include folder by its name.
function(oilskin_install_library export target headers)
  target_include_directories(${target} PUBLIC $<INSTALL_INTERFACE:${CMAKE_INSTALL_INCLUDEDIR}>)
  install(TARGETS ${target} EXPORT ${export} ARCHIVE COMPONENT development)
  install(DIRECTORY ${headers} DESTINATION ${CMAKE_INSTALL_INCLUDEDIR} COMPONENT development FILES_MATCHING PATTERN "*.h")
endfunction()

function(oilskin_install_export export)
  install(EXPORT ${export} FILE ${export}Targets.cmake NAMESPACE oilskin:: DESTINATION ${oilskin_package_dir}
          COMPONENT development)
endfunction()

oilskin_install_library(oilskin oilskin ${PROJECT_SOURCE_DIR}/src/oilskin)
if(TARGET oilskin_reconstruction)
  oilskin_install_library(oilskin oilskin_reconstruction ${PROJECT_SOURCE_DIR}/src/oilskin)
  set_target_properties(oilskin_reconstruction PROPERTIES EXPORT_NAME reconstruction)
endif()
oilskin_install_export(oilskin)

# An export of its own for each adapter: a program that wants contact alone need not have Bullet.
set(oilskin_upstream_adapter)
foreach(adapter bullet bullet_f64)
  if(TARGET oilskin_${adapter})
    oilskin_install_library(oilskin_${adapter} oilskin_${adapter} ${PROJECT_SOURCE_DIR}/bullet_adapter/oilskin)
    get_target_property(libraries oilskin_${adapter} INTERFACE_LINK_LIBRARIES)
    if(oilskin_bullet_upstream IN_LIST libraries)
      set(oilskin_upstream_adapter ${adapter})
      install(TARGETS oilskin_bullet_upstream EXPORT oilskin_${adapter} COMPONENT development)
    endif()
    oilskin_install_export(oilskin_${adapter})
  endif()
endforeach()

# Which Bullet each adapter was built with: pkg-config's, or one that its own export names. Of the latter those that were
# targets of another project; an installed copy needs targets of the same names.
set(oilskin_bullet_module bullet)
set(oilskin_bullet_f64_module bullet-float64)
set(oilskin_bullet_target_names)
if(oilskin_upstream_adapter)
  set(oilskin_${oilskin_upstream_adapter}_module "")
  foreach(name ${OILSKIN_BULLET_TARGETS})
    if(TARGET ${name})
      list(APPEND oilskin_bullet_target_names ${name})
    endif()
  endforeach()
endif()
configure_package_config_file(${CMAKE_CURRENT_LIST_DIR}/oilskinConfig.cmake.in ${PROJECT_BINARY_DIR}/oilskinConfig.cmake
                              INSTALL_DESTINATION ${oilskin_package_dir} NO_SET_AND_CHECK_MACRO)
write_basic_package_version_file(${PROJECT_BINARY_DIR}/oilskinConfigVersion.cmake COMPATIBILITY SameMinorVersion)
install(FILES ${PROJECT_BINARY_DIR}/oilskinConfig.cmake ${PROJECT_BINARY_DIR}/oilskinConfigVersion.cmake
        DESTINATION ${oilskin_package_dir} COMPONENT development)
include(${CMAKE_CURRENT_LIST_DIR}/OilskinPkgConfig.cmake)
