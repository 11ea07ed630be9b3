# The scenes that `slipstick --new NAME` writes, as text in a source of the layer app.
set(scenes prm/new/block.prm prm/hertz.prm prm/incline.prm prm/new/pin.prm prm/new/shrink.prm)
set(entries "")
foreach(scene ${scenes})
  get_filename_component(name ${scene} NAME_WE)
  file(READ ${CMAKE_SOURCE_DIR}/${scene} text)
  string(APPEND entries "          {\"${name}\", R\"prm(${text})prm\"},\n")
  set_property(DIRECTORY APPEND PROPERTY CMAKE_CONFIGURE_DEPENDS ${CMAKE_SOURCE_DIR}/${scene})
endforeach()
file(
  CONFIGURE
  OUTPUT generated/new_scene_texts.cc
  CONTENT "// Written by cmake/new_scenes.cmake.
#include <slipstick/app/new_scene.h>

namespace slipstick::app
{
  std::vector<std::pair<std::string, std::string>> new_scene_texts()
  {
    return {
@entries@    };
  }
} // namespace slipstick::app
"
  @ONLY)
target_sources(slipstick_app PRIVATE ${CMAKE_BINARY_DIR}/generated/new_scene_texts.cc)
