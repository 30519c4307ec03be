# Installed for a package alone, after all else: manual pages and changes, compressed as Debian has them.
set(root $ENV{DESTDIR}${CMAKE_INSTALL_PREFIX}/share)
set(documents ${root}/doc/clothlab)
file(GLOB pages ${root}/man/man1/*.1)
configure_file(${CMAKE_CURRENT_LIST_DIR}/../../CHANGELOG.md ${documents}/changelog COPYONLY)
string(TIMESTAMP now "%a, %d %b %Y %H:%M:%S +0000" UTC)
file(WRITE ${documents}/changelog.Debian
     "clothlab (${version}) unstable; urgency=medium\n\n  * What is new is in changelog.gz.\n\n"
     " -- ${maintainer}  ${now}\n")
execute_process(COMMAND gzip -9nf ${pages} ${documents}/changelog ${documents}/changelog.Debian
                COMMAND_ERROR_IS_FATAL ANY)
