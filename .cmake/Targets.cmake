# haarlight_precompile(TARGET): lets a library's sources share one precompiled header of all libraries.
function(haarlight_precompile target)
  if(NOT HAARLIGHT_PRECOMPILE)
    return()
  elseif(target STREQUAL haarlight_wavelet)
    target_precompile_headers(${target} PRIVATE ${HAARLIGHT_COMMON_HEADERS})
  else()
    target_precompile_headers(${target} REUSE_FROM haarlight_wavelet)
  endif()
endfunction()

# haarlight_unity(TARGET): compiles the sources of a target in batches.
function(haarlight_unity target)
  if(NOT HAARLIGHT_UNITY_BATCH EQUAL 1)
    set_target_properties(${target} PROPERTIES UNITY_BUILD ON UNITY_BUILD_BATCH_SIZE ${HAARLIGHT_UNITY_BATCH})
  endif()
endfunction()

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
  haarlight_precompile(haarlight_${name})
  haarlight_unity(haarlight_${name})
  install(TARGETS haarlight_${name} EXPORT haarlightTargets FILE_SET HEADERS)
endfunction()

# haarlight_tool(NAME SOURCES … LINKS …): one installed command-line program.
function(haarlight_tool name)
  cmake_parse_arguments(arg "" "" "SOURCES;LINKS" ${ARGN})
  add_executable(${name} ${arg_SOURCES})
  target_link_libraries(${name} PRIVATE haarlight_tool_support ${arg_LINKS} haarlight_settings)
  install(TARGETS ${name} RUNTIME)
endfunction()

# haarlight_tool_library(NAME SOURCES … PUBLIC … PRIVATE …): what several programs share; included as <folder/x.h>.
function(haarlight_tool_library name)
  cmake_parse_arguments(arg "" "" "SOURCES;PUBLIC;PRIVATE" ${ARGN})
  add_library(${name} STATIC ${arg_SOURCES})
  target_include_directories(${name} PUBLIC ${PROJECT_SOURCE_DIR}/tools)
  target_link_libraries(${name} PUBLIC ${arg_PUBLIC} haarlight::wavelet PRIVATE ${arg_PRIVATE} haarlight_settings)
  haarlight_precompile(${name})
  haarlight_unity(${name})
endfunction()
