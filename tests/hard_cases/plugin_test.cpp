// SPDX-License-Identifier: Apache-2.0
/// Libraries that cannot be trusted are refused in words, and only those that a scene names are
/// opened. The bad ones are in the folder `plugins` beside this file.
#include "core/base/error.h"
#include "core/description/xml_reader.h"
#include "core/interfaces/bsdf.h"
#include "core/scene/builder.h"
#include "tests/paths.h"
#include "tests/render_scene.h"

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <xmmintrin.h>

#include <fstream>
#include <sstream>

namespace lucerna {
namespace {

namespace fs = std::filesystem;
using testing::HasSubstr;

fs::path bad_plugins() { return program_path().parent_path().parent_path() / "tests" / "plugins"; }

std::string bytes_of(const fs::path& path) {
    std::ostringstream text;
    text << std::ifstream(path, std::ios::binary).rdbuf();
    return text.str();
}

std::string library(std::string_view kind, std::string_view name) {
    const std::string bytes = bytes_of(Registry().path(kind, name));
    EXPECT_FALSE(bytes.empty());
    return bytes;
}

/// A folder of plugins that holds one BSDF, "it", of these bytes.
class FolderOfOne {
public:
    explicit FolderOfOne(const std::string& bytes) {
        fs::create_directory(folder_ / "bsdfs");
        write_file(folder_ / "bsdfs/it.so", bytes);
    }
    const fs::path& path() const { return folder_.path(); }

    /// What the registry says about it; empty if it opens it.
    std::string complaint() const {
        Registry registry({path()});
        try {
            registry.find("bsdf", "it");
            return "";
        } catch (const PluginError& error) {
            return error.what();
        }
    }

private:
    TemporaryFolder folder_;
};

std::string complaint_about(const std::string& name) {
    Registry registry({bad_plugins()});
    try {
        registry.find("bsdf", name);
        return "";
    } catch (const PluginError& error) {
        return error.what();
    }
}

TEST(BadLibraries, M1_EmptyTextAndForeign) {
    EXPECT_THAT(FolderOfOne("").complaint(), HasSubstr("it is not an ELF file"));
    EXPECT_THAT(FolderOfOne("#!/bin/sh\necho hello\n").complaint(),
                HasSubstr("it is not an ELF file"));
    EXPECT_THAT(FolderOfOne(std::string(5000, '\0')).complaint(),
                HasSubstr("it is not an ELF file"));
    std::string narrow = library("bsdf", "diffuse");
    narrow[4] = 1;  // ELFCLASS32
    EXPECT_THAT(FolderOfOne(narrow).complaint(), HasSubstr("it is not a 64-bit library"));
    const TemporaryFolder folder;
    fs::create_directories(folder / "bsdfs/it.so");
    Registry registry({folder.path()});
    EXPECT_THROW(registry.find("bsdf", "it"), PluginError);
}

TEST(BadLibraries, M2_TruncatedAtAnyLength) {
    const std::string whole = library("bsdf", "diffuse");
    for (int i = 1; i < 40; ++i) {
        const std::string part = whole.substr(0, whole.size() * static_cast<std::size_t>(i) / 40);
        EXPECT_THAT(FolderOfOne(part).complaint(), HasSubstr("it is truncated"))
            << part.size() << " of " << whole.size();
    }
    EXPECT_THAT(FolderOfOne(whole.substr(0, whole.size() - 1)).complaint(),
                HasSubstr("it is truncated"));
    EXPECT_EQ(FolderOfOne(whole).complaint(), "");
}

TEST(BadLibraries, M3_MissingSymbol) {
    EXPECT_THAT(complaint_about("missing_symbol"), HasSubstr("lucerna_function_that_nobody_has"));
    EXPECT_THAT(complaint_about("no_plugin"), HasSubstr("exports no plugin"));
}

/// A folder of stale plugins would else fill the screen with a complaint for each use.
TEST(BadLibraries, M4_IsSaidOnceHoweverOftenASceneNamesIt) {
    const FolderOfOne broken("");
    Registry registry({broken.path()});
    Diagnostics diagnostics;
    const std::string sphere = "<shape type='sphere'><bsdf type='it'/></shape>";
    const Description description = read_scene_text(
        "<scene version='3.0.0'>" + sphere + sphere + "</scene>", "a.xml", {}, diagnostics);
    try {
        build_scene(description, registry, diagnostics);
        FAIL() << "it was built";
    } catch (const PluginError& error) {
        const std::string text = error.what();
        const std::size_t first = text.find("it is not an ELF file");
        ASSERT_NE(first, std::string::npos) << text;
        EXPECT_EQ(text.find("it is not an ELF file", first + 1), std::string::npos) << text;
    }
}

/// The text that stands for the contracts differs in one letter, at several places of it.
TEST(BadLibraries, M4_BuiltForAnotherVersion) {
    const std::string good = library("bsdf", "diffuse");
    const std::size_t abi = good.find("lucerna 0");
    ASSERT_NE(abi, std::string::npos);
    const std::size_t length = good.find('\0', abi) - abi;
    for (const std::size_t at : {std::size_t{8}, length / 2, length - 1}) {
        std::string stale = good;
        stale[abi + at] = 'x';
        EXPECT_THAT(FolderOfOne(stale).complaint(), HasSubstr("was built for another Lucerna"));
    }
    std::string foreign = good;
    const std::uint64_t magic = plugin_magic;
    const std::size_t place = good.find(std::string(reinterpret_cast<const char*>(&magic), 8));
    ASSERT_NE(place, std::string::npos);
    foreign[place + 3] = 'x';
    EXPECT_THAT(FolderOfOne(foreign).complaint(), HasSubstr("was built for another Lucerna"));
    foreign = good;
    foreign[place + 8] = 1;  // the size of its description
    EXPECT_THAT(FolderOfOne(foreign).complaint(), HasSubstr("was built for another Lucerna"));
}

TEST(BadLibraries, M4_AnotherKindOfPlugin) {
    EXPECT_THAT(FolderOfOne(library("emitter", "point")).complaint(),
                HasSubstr("is a plugin for <emitter>, not for <bsdf>"));
}

TEST(BadLibraries, M5_M8_ConstructorsThatThrow) {
    for (const auto& [what, message] :
         {std::pair("error", "the plugin does not like this"),
          {"private", "something went wrong inside"},
          {"memory", "not enough memory for bsdf \"throws_when_made\""}}) {
        try {
            const TestScene scene(fmt::format("<shape type='sphere'><bsdf type='throws_when_made'>"
                                              "<string name='what' value='{}'/></bsdf></shape>",
                                              what),
                                  Registry({bad_plugins()}));
            ADD_FAILURE() << what;
        } catch (const SceneError& error) {
            EXPECT_THAT(error.what(), HasSubstr(message));
            EXPECT_THAT(error.what(), HasSubstr("test.xml:1:"));
        }
    }
}

/// It cannot be caught: the process ends at once and says why, instead of going on wrongly.
TEST(BadLibrariesDeathTest, M6_AGlobalThatThrowsEndsTheProgram) {
    testing::GTEST_FLAG(death_test_style) = "threadsafe";
    EXPECT_DEATH(complaint_about("throws_when_loaded"), "thrown by a global");
}

TEST(BadLibraries, M7_N11_ALibraryThatChangesRounding) {
    const unsigned before = _mm_getcsr();
    EXPECT_THAT(complaint_about("flush_to_zero"), HasSubstr("-ffast-math"));
    EXPECT_EQ(_mm_getcsr(), before);
}

/// A library stays, even if the registry that opened it has gone.
TEST(Libraries, M9_NothingIsUnloadedThatIsInUse) {
    std::vector<std::unique_ptr<Object>> objects;
    const BSDF* bsdf = nullptr;
    {
        Registry registry;
        Diagnostics diagnostics;
        const Description description = read_scene_text(
            "<scene version='3.0.0'><bsdf type='phong'/></scene>", "test.xml", {}, diagnostics);
        bsdf = static_cast<const BSDF*>(build_object(*description.root->children.at(0).element,
                                                     description, registry, diagnostics, objects));
    }
    ASSERT_TRUE(bsdf);
    EXPECT_TRUE(any(bsdf->lobes() & Lobe::glossy_reflection));
    EXPECT_GT(bsdf->evaluate({}, {0, 0, 1}, {0, 0, 1}, TransportMode::radiance).f.x, 0);
}

TEST(Libraries, M10_TheFirstFolderWins) {
    const TemporaryFolder folder;
    fs::create_directory(folder / "bsdfs");
    write_file(folder / "bsdfs/diffuse.so", library("bsdf", "conductor"));
    Registry registry({folder.path()});
    EXPECT_EQ(registry.path("bsdf", "diffuse"), folder / "bsdfs/diffuse.so");
    EXPECT_STREQ(registry.find("bsdf", "diffuse").summary,
                 Registry().find("bsdf", "conductor").summary);
}

TEST(Libraries, P10_NamesCannotLeaveTheirFolder) {
    Registry registry;
    for (const char* name : {"../bsdfs/diffuse", "/etc/passwd", "", "diffuse.so", "a/b", "."}) {
        EXPECT_TRUE(registry.path("bsdf", name).empty()) << name;
        EXPECT_THROW(registry.find("bsdf", name), Error) << name;
    }
}

/// Nothing is opened but what the scene names and the defaults of what it names.
TEST(Libraries, OnlyWhatASceneNamesIsOpened) {
    TestScene scene(path_integrator() + xml({.to_world = look({0, 0, 5}, {0, 0, 0})}) +
                    sphere({0, 0, 0}, 1, diffuse(0.5)) + point_light({0, 5, 0}, 1));
    scene.render({});
    EXPECT_EQ(
        scene.registry().opened(),
        (std::vector<std::string>{"bsdfs/diffuse", "emitters/point", "films/hdrfilm",
                                  "integrators/path", "light_samplers/cache", "rfilters/box",
                                  "samplers/independent", "sensors/perspective", "shapes/sphere"}));
    TestScene other("<integrator type='depth'/>" + xml({.to_world = look({0, 0, 5}, {0, 0, 0})}));
    EXPECT_EQ(other.registry().opened(),
              (std::vector<std::string>{"films/hdrfilm", "integrators/depth", "rfilters/box",
                                        "samplers/independent", "sensors/perspective"}));
}

/// A definition that nothing refers to costs nothing.
TEST(Libraries, UnusedDefinitionsAreNotOpened) {
    TestScene scene("<bsdf type='dielectric' id='glass'/>" + sphere({0, 0, 0}, 1, ""));
    const std::vector<std::string> opened = scene.registry().opened();
    EXPECT_EQ(std::count(opened.begin(), opened.end(), "bsdfs/dielectric"), 0);
}

}  // namespace
}  // namespace lucerna
