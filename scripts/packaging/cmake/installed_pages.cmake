# Run by `cmake --install`, after the pages are where they belong: their commands name programs and
# shipped files as they are installed, not as they lie in a build.
set(data ${CMAKE_INSTALL_PREFIX}/share/plumbline)
file(GLOB pages $ENV{DESTDIR}${data}/README.md $ENV{DESTDIR}${data}/docs/*.md)
foreach(page ${pages})
  file(READ ${page} text)
  string(REPLACE "build/bin/" "" text "${text}")
  string(REPLACE "=configs/" "=${data}/configs/" text "${text}")
  file(WRITE ${page} "${text}")
endforeach()
