# Pictures of the presets for the page's gallery, drawn by the program itself. As a script (`cmake -P`) it draws one:
# PROGRAM, PRESET, TIME [s], OUT. A machine without OpenGL builds all the same; the page then shows the names alone.
if(CMAKE_SCRIPT_MODE_FILE)
  execute_process(COMMAND ${PROGRAM} render ${PRESET} --time ${TIME} --size 320x200 --out ${OUT}
                  RESULT_VARIABLE status OUTPUT_QUIET ERROR_VARIABLE why)
  if(NOT status MATCHES "^[04]$")  # 4: it blew up, and the picture is that of the last good state
    message(STATUS "no picture of the preset ${PRESET}: ${why}")
  endif()
  return()
endif()

# The moment [s] at which a preset shows what it is about, where that is not the usual one.
set(usual 1.2)
set(moment_cantilever 0.6)
set(moment_funnel 0.35)
set(moment_knot 0.8)
set(moment_stack 0.8)
set(moment_tablecloth-pull 0.4)
set(moment_trampoline 0.6)

file(GLOB presets CONFIGURE_DEPENDS ${PROJECT_SOURCE_DIR}/server/scene/presets/*.json)
if(CLOTHLAB_QUICK_BUILD)  # the gallery's first
  list(FILTER presets INCLUDE REGEX "/seed\\.json$")
endif()
set(pictures)
file(MAKE_DIRECTORY ${PROJECT_SOURCE_DIR}/web/pictures)
foreach(preset ${presets})
  cmake_path(GET preset STEM name)
  set(moment ${usual})
  if(DEFINED moment_${name})
    set(moment ${moment_${name}})
  endif()
  set(picture ${PROJECT_SOURCE_DIR}/web/pictures/${name}.png)
  # Not of the program: a picture a build would be too many. `rm -r web/pictures` makes all anew.
  add_custom_command(
    OUTPUT ${picture}
    COMMAND ${CMAKE_COMMAND} -DPROGRAM=$<TARGET_FILE:clothlab> -DPRESET=${name} -DTIME=${moment} -DOUT=${picture}
            -P ${CMAKE_CURRENT_LIST_FILE}
    DEPENDS ${preset} ${CMAKE_CURRENT_LIST_FILE}
    COMMENT "Drawing the preset ${name}")
  list(APPEND pictures ${picture})
endforeach()
add_custom_target(pictures ALL DEPENDS ${pictures})
add_dependencies(pictures clothlab)
