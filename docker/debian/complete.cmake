# Before a package is made: all that it shall hold has been built.
foreach(file web/dist/index.html web/pictures/seed.png)
  if(NOT EXISTS ${CPACK_CLOTHLAB_SOURCES}/${file})
    message(FATAL_ERROR "${file} is missing: a package without it would serve no page, or no pictures of its presets.\n"
            "Run docker/debian/package, which builds all and then packs, or `npm --prefix web ci && "
            "npm --prefix web run build` and `cmake --build build/release`.")
  endif()
endforeach()
if(NOT EXISTS ${CPACK_CLOTHLAB_MANUAL}/clothlab.1)
  message(FATAL_ERROR "the manual pages are missing: cmake --build build/release --target manual")
endif()
