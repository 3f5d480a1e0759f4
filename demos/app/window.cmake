# The window of the command `view`. Without its libraries the command is refused when the program runs.
if(OILSKIN_WINDOW)
  find_package(glfw3 3.3 QUIET)
  find_package(PNG QUIET)
  find_path(OILSKIN_GL_HEADERS GL/glcorearb.h)
  find_path(OILSKIN_IMGUI_HEADERS imgui.h PATH_SUFFIXES imgui)
  find_library(OILSKIN_IMGUI imgui)
  find_library(OILSKIN_STB stb)  # the fonts of Debian's ImGui
endif()

if(OILSKIN_WINDOW AND TARGET glfw AND TARGET PNG::PNG AND OILSKIN_GL_HEADERS AND OILSKIN_IMGUI_HEADERS AND OILSKIN_IMGUI)
  add_library(oilskin_app_window STATIC view/gl.cpp view/painter.cpp view/panel.cpp view/png_file.cpp view/window.cpp)
  target_include_directories(oilskin_app_window SYSTEM PRIVATE ${OILSKIN_IMGUI_HEADERS} ${OILSKIN_GL_HEADERS})
  target_link_libraries(oilskin_app_window PRIVATE ${OILSKIN_IMGUI} $<$<BOOL:${OILSKIN_STB}>:${OILSKIN_STB}> glfw PNG::PNG
                        ${CMAKE_DL_LIBS})
  set_property(GLOBAL PROPERTY OILSKIN_HAS_WINDOW ON)  # asked by tests/view
else()
  message(STATUS "No window in the programs: GLFW 3.3, ImGui or libpng (Debian: libglfw3-dev, libimgui-dev, libpng-dev) "
                 "was not found, or OILSKIN_WINDOW is OFF")
  add_library(oilskin_app_window STATIC view/view_none.cpp)
endif()
target_link_libraries(oilskin_app_window PUBLIC oilskin_app_view PRIVATE oilskin_flags)
