# SPDX-License-Identifier: Apache-2.0
# The page of `--preview web`, compiled into the plugin.
set(preview_page ${CMAKE_CURRENT_BINARY_DIR}/preview_page.cpp)
set(preview_folder ${CMAKE_CURRENT_SOURCE_DIR}/previews/page)
file(GLOB preview_parts CONFIGURE_DEPENDS ${preview_folder}/*)
add_custom_command(OUTPUT ${preview_page} VERBATIM
    COMMAND ${CMAKE_COMMAND} -D FOLDER=${preview_folder} -D OUTPUT=${preview_page}
            -P ${preview_folder}/embed.cmake
    DEPENDS ${preview_parts} ${CMAKE_CURRENT_SOURCE_DIR}/embed_text.cmake
    COMMENT "Putting the page of `--preview web` together")
target_sources(plugin_previews_web PRIVATE ${preview_page})
