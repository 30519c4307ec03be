# What a system shows of the program beside itself (manual pages, a completion for bash, the service), and the .deb:
# `cpack --config build/release/CPackConfig.cmake`, which docker/debian/package calls.
set(here ${CMAKE_CURRENT_LIST_DIR})
set(made ${CMAKE_BINARY_DIR}/package)

string(TIMESTAMP today "%Y-%m-%d" UTC)  # or the day of SOURCE_DATE_EPOCH
set(manual ${made}/manual)
add_custom_command(
  OUTPUT ${manual}/clothlab.1
  COMMAND clothlab manual --out ${manual} --date ${today}
  DEPENDS clothlab VERBATIM)
add_custom_target(manual ALL DEPENDS ${manual}/clothlab.1)
# Whoever has built the program alone installs it without these.
install(DIRECTORY ${manual}/ DESTINATION ${CMAKE_INSTALL_MANDIR}/man1 OPTIONAL FILES_MATCHING PATTERN "*.1")
install(FILES ${manual}/clothlab.bash DESTINATION ${CMAKE_INSTALL_DATADIR}/bash-completion/completions
        RENAME clothlab OPTIONAL)
install(FILES ${here}/clothlab.service DESTINATION lib/systemd/system)
install(FILES ${here}/clothlab.sysusers DESTINATION lib/sysusers.d RENAME clothlab.conf)

# The rest is for the .deb alone, whose paths are those of the system.
set(debian COMPONENT debian EXCLUDE_FROM_ALL)
install(FILES ${here}/clothlab.default DESTINATION /etc/default RENAME clothlab
        PERMISSIONS OWNER_READ OWNER_WRITE ${debian})
install(FILES ${here}/lintian-overrides DESTINATION ${CMAKE_INSTALL_DATADIR}/lintian/overrides
        RENAME clothlab ${debian})
install(FILES ${here}/copyright DESTINATION ${CMAKE_INSTALL_DATADIR}/doc/clothlab ${debian})

# "debian12": a package of one system needs that one's libraries, and is older than the next one's.
cmake_host_system_information(RESULT system QUERY DISTRIB_INFO)
set(CPACK_GENERATOR DEB)
set(CPACK_PACKAGE_NAME clothlab)
set(CPACK_PACKAGE_DIRECTORY ${CMAKE_BINARY_DIR})
set(CPACK_DEBIAN_FILE_NAME DEB-DEFAULT)
set(CPACK_DEBIAN_PACKAGE_RELEASE 1~${system_ID}${system_VERSION_ID})
set(CLOTHLAB_MAINTAINER "The Clothlab authors <clothlab@packages.invalid>"
    CACHE STRING "Whom the .deb names as who packed it")
set(CPACK_DEBIAN_PACKAGE_MAINTAINER ${CLOTHLAB_MAINTAINER})
set(CPACK_DEBIAN_PACKAGE_SECTION science)
set(CPACK_PACKAGE_DESCRIPTION_SUMMARY "cloth simulated on the GPU, shown live in the browser")
set(CPACK_PACKAGE_DESCRIPTION
"Clothlab simulates cloth on the GPU of a server without a screen and streams
it, as it moves, to a page in the browser that draws it and changes it back.
It charts every method's error against its cost, maps where each becomes
unstable, and picks the cheapest that is good enough.")
install(CODE "set(version ${PROJECT_VERSION}-${CPACK_DEBIAN_PACKAGE_RELEASE})" ${debian})
install(CODE "set(maintainer \"${CPACK_DEBIAN_PACKAGE_MAINTAINER}\")" ${debian})
install(SCRIPT ${here}/documents.cmake ${debian})
set(CPACK_STRIP_FILES ON)
set(CPACK_DEBIAN_PACKAGE_SHLIBDEPS ON)
# Loaded at run time: EGL, which finds the driver and OpenGL's functions in it; and a driver, Mesa's, which machines
# with another one do without.
set(CPACK_DEBIAN_PACKAGE_DEPENDS libegl1)
set(CPACK_DEBIAN_PACKAGE_RECOMMENDS libgl1-mesa-dri)
set(CPACK_DEBIAN_PACKAGE_SUGGESTS "nats-server, python3-numpy")
set(CPACK_DEBIAN_PACKAGE_CONTROL_EXTRA ${here}/postinst ${here}/prerm ${here}/postrm ${here}/conffiles)
set(CPACK_DEBIAN_PACKAGE_CONTROL_STRICT_PERMISSION ON)
set(CPACK_SET_DESTDIR ON)  # for /etc
set(CPACK_INSTALL_PREFIX /usr)
set(CPACK_INSTALL_CMAKE_PROJECTS "${CMAKE_BINARY_DIR};clothlab;ALL;/" "${CMAKE_BINARY_DIR};clothlab;debian;/")
set(CPACK_INSTALL_DEFAULT_DIRECTORY_PERMISSIONS
    OWNER_READ OWNER_WRITE OWNER_EXECUTE GROUP_READ GROUP_EXECUTE WORLD_READ WORLD_EXECUTE)
set(CPACK_PROJECT_CONFIG_FILE ${here}/complete.cmake)
set(CPACK_CLOTHLAB_SOURCES ${PROJECT_SOURCE_DIR})
set(CPACK_CLOTHLAB_MANUAL ${manual})
include(CPack)
