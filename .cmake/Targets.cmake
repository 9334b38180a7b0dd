# haarlight_library(NAME FOLDER SOURCES … HEADERS … PUBLIC … PRIVATE …)
# One installed static library haarlight::NAME whose public headers live in FOLDER/include/NAME.
function(haarlight_library name)
  cmake_parse_arguments(arg "" "" "SOURCES;HEADERS;PUBLIC;PRIVATE" ${ARGN})
  add_library(haarlight_${name} STATIC ${arg_SOURCES})
  add_library(haarlight::${name} ALIAS haarlight_${name})
  set_target_properties(haarlight_${name} PROPERTIES EXPORT_NAME ${name} VERIFY_INTERFACE_HEADER_SETS ON)
  target_sources(haarlight_${name} PUBLIC FILE_SET HEADERS BASE_DIRS include FILES ${arg_HEADERS})
  target_include_directories(haarlight_${name} PRIVATE src)
  target_compile_features(haarlight_${name} PUBLIC cxx_std_20)
  target_link_libraries(haarlight_${name} PUBLIC ${arg_PUBLIC} PRIVATE ${arg_PRIVATE}
                        $<BUILD_INTERFACE:haarlight_settings>)
  install(TARGETS haarlight_${name} EXPORT haarlightTargets FILE_SET HEADERS)
endfunction()

# haarlight_tool(NAME SOURCES … LINKS …): one installed command-line program.
function(haarlight_tool name)
  cmake_parse_arguments(arg "" "" "SOURCES;LINKS" ${ARGN})
  add_executable(${name} ${arg_SOURCES})
  target_link_libraries(${name} PRIVATE haarlight_tool_support ${arg_LINKS} haarlight_settings)
  install(TARGETS ${name} RUNTIME)
endfunction()
