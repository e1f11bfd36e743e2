// SPDX-License-Identifier: Apache-2.0
/// Wrong scenes and the exact words in which they are refused: each folder/name.xml has what the
/// program says about it beside it, in folder/name.txt. A scene may begin with the options it is
/// read with: `<!-- options: -D spp=4 --set integrator=path -->`.
///
/// After a message was changed on purpose, LUCERNA_UPDATE=1 writes the files anew; the difference
/// is then for the author to read. A scene that turns out to be right is a failure either way.
#include "core/description/xml_reader.h"
#include "core/plugin/registry.h"
#include "core/scene/builder.h"
#include "tests/paths.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <sstream>
#include <string>
#include <vector>

namespace lucerna {
namespace {

std::vector<std::string> wrong_scenes() {
    const std::filesystem::path folder = tests_folder() / "errors";
    std::vector<std::string> names;
    for (const auto& entry : std::filesystem::recursive_directory_iterator(folder)) {
        const std::filesystem::path name = entry.path().lexically_relative(folder);
        // Files in a folder `parts` are included by other scenes.
        const bool part = name.parent_path().filename() == "parts";
        if (name.extension() == ".xml" && !part) names.push_back(name.string());
    }
    std::sort(names.begin(), names.end());
    return names;
}

std::string read_text(const std::filesystem::path& path) {
    std::ifstream file(path, std::ios::binary);
    std::ostringstream text;
    text << file.rdbuf();
    return text.str();
}

void replace_all(std::string& text, const std::string& from, const std::string& to) {
    for (std::size_t at = text.find(from); at != std::string::npos;
         at = text.find(from, at + to.size())) {
        text.replace(at, from.size(), to);
    }
}

ReadOptions options_of(const std::string& scene) {
    ReadOptions options;
    std::istringstream words(scene.substr(0, scene.find('\n')));
    std::string word, value;
    words >> word;
    if (word != "<!--" || !(words >> word) || word != "options:") return options;
    while (words >> word && word != "-->" && words >> value) {
        const std::size_t equals = std::min(value.find('='), value.size() - 1);
        if (word == "--set") options.overrides.push_back(value);
        if (word == "-D")
            options.defines.emplace_back(value.substr(0, equals), value.substr(equals + 1));
    }
    return options;
}

/// What the program says about the scene, without the folders of this machine.
std::string complaint(const std::filesystem::path& scene) {
    Registry registry;
    Diagnostics diagnostics;
    std::string text;
    try {
        const Description description =
            read_scene(scene, options_of(read_text(scene)), diagnostics);
        build_scene(description, registry, diagnostics);
    } catch (const Error& error) {
        text = std::string(error.what()) + "\n";
    }
    for (const std::filesystem::path& folder : registry.folders()) {
        replace_all(text, folder.string(), "PLUGINS");
    }
    replace_all(text, std::filesystem::current_path().string() + "/", "");
    return text;
}

class ErrorMessages : public testing::TestWithParam<std::string> {};

TEST_P(ErrorMessages, AreExact) {
    const std::filesystem::path path = tests_folder() / "errors" / GetParam();
    // Messages then name the scene as its author would: by a relative path.
    std::filesystem::current_path(path.parent_path());
    const std::filesystem::path scene = path.filename();
    const std::string said = complaint(scene);
    ASSERT_NE(said, "") << scene << " is accepted, but should not be";

    const std::filesystem::path expected = std::filesystem::path(scene).replace_extension("txt");
    if (std::getenv("LUCERNA_UPDATE")) std::ofstream(expected, std::ios::binary) << said;
    EXPECT_EQ(said, read_text(expected));
}

/// "xml/not_closed.xml" → "xml_not_closed": names of tests are identifiers.
std::string test_name(const testing::TestParamInfo<std::string>& info) {
    std::string name = std::filesystem::path(info.param).replace_extension().string();
    for (char& c : name) {
        if (!std::isalnum(static_cast<unsigned char>(c))) c = '_';
    }
    return name;
}

INSTANTIATE_TEST_SUITE_P(Scenes, ErrorMessages, testing::ValuesIn(wrong_scenes()), test_name);
GTEST_ALLOW_UNINSTANTIATED_PARAMETERIZED_TEST(ErrorMessages);

}  // namespace
}  // namespace lucerna
