# deal.II's exported flags name the linker that it was built with (mold on Debian 13), which its package does not bring: where
# it is not here, the compiler's own links as well.
string(REGEX MATCH "-fuse-ld=([a-z]+)" asked_linker "${DEAL_II_LINKER_FLAGS}")
if(asked_linker)
  find_program(DEAL_II_LINKER ld.${CMAKE_MATCH_1})
  if(NOT DEAL_II_LINKER)
    message(STATUS "deal.II asks for ${asked_linker}, which is not installed: linking without it")
    string(REPLACE "${asked_linker}" "" DEAL_II_LINKER_FLAGS "${DEAL_II_LINKER_FLAGS}")
    if(NOT DEAL_II_TARGET_CONFIG_INCLUDED) # as deal_ii_setup_target does
      include(${DEAL_II_TARGET_CONFIG})
      set(DEAL_II_TARGET_CONFIG_INCLUDED TRUE)
    endif()
    foreach(target dealii::dealii dealii::dealii_debug dealii::dealii_release) # of 9.6; older ones have the flags above only
      if(TARGET ${target})
        get_target_property(options ${target} INTERFACE_LINK_OPTIONS)
        if(options)
          string(REPLACE "${asked_linker}" "" options "${options}")
          set_target_properties(${target} PROPERTIES INTERFACE_LINK_OPTIONS "${options}")
        endif()
      endif()
    endforeach()
  endif()
endif()
