// SPDX-License-Identifier: Apache-2.0
/// import: a COLLADA, glTF or OBJ model as a scene.
///
/// The only part of Lucerna that uses assimp; it is built where assimp is found. The model becomes
/// an XML file, and a folder beside it with its meshes as PLY files (model.h). The scene is
/// written last: where it is, all is there.
#include "core/base/atomic_file.h"
#include "core/base/error.h"
#include "core/command_line/arguments.h"
#include "core/interfaces/command.h"
#include "core/render/interrupt.h"
#include "plugins/commands/import/model.h"

#include <assimp/postprocess.h>
#include <assimp/Importer.hpp>

#include <fmt/format.h>

#include <filesystem>

namespace lucerna {

namespace {

namespace fs = std::filesystem;

std::string lower_extension(const fs::path& file) {
    std::string extension = file.extension().string();
    for (char& c : extension) c = static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
    return extension;
}

/// Throws FileError.
const aiScene& read_model(Assimp::Importer& importer, const fs::path& file) {
    std::error_code problem;
    if (!fs::exists(file, problem)) {
        throw FileError(fmt::format("{}: there is no such file", file.string()));
    }
    if (!fs::is_regular_file(file, problem)) {
        throw FileError(fmt::format("{} is not a file", file.string()));
    }
    const std::string extension = lower_extension(file);
    if (extension != ".dae" && extension != ".gltf" && extension != ".glb" && extension != ".obj") {
        throw FileError(
            fmt::format("{}: only .dae, .gltf, .glb and .obj can be imported", file.string()));
    }
    // Vertices that are equal become one, so that meshes without normals look smooth.
    const aiScene* scene = importer.ReadFile(
        file.string(), aiProcess_Triangulate | aiProcess_JoinIdenticalVertices |
                           aiProcess_SortByPType | aiProcess_ValidateDataStructure);
    if (!scene || !scene->mRootNode) {
        throw FileError(fmt::format("{} cannot be read as a model: {}", file.string(),
                                    importer.GetErrorString()));
    }
    if (scene->mNumMeshes == 0) {
        throw FileError(fmt::format("{} has no meshes", file.string()));
    }
    return *scene;
}

/// The first file that would be overwritten, or empty.
std::string in_the_way(const fs::path& scene, const std::vector<SideFile>& files) {
    std::error_code problem;
    if (fs::exists(scene, problem)) return scene.string();
    for (const SideFile& file : files) {
        const fs::path path = scene.parent_path() / file.name;
        if (fs::exists(path, problem)) return path.string();
    }
    return "";
}

void write(const fs::path& scene, const ImportedModel& model) {
    for (const SideFile& file : model.files) {
        const fs::path path = scene.parent_path() / file.name;
        std::error_code problem;
        fs::create_directories(path.parent_path(), problem);
        if (problem) {
            throw FileError(fmt::format("the folder {} cannot be made: {}",
                                        path.parent_path().string(), problem.message()));
        }
        write_file_atomically(path, file.bytes);
    }
    write_file_atomically(scene, "<?xml version=\"1.0\" encoding=\"utf-8\"?>\n" + model.text);
}

class ImportCommand final : public Command {
public:
    explicit ImportCommand(const Params&) {}

    int run(const std::vector<std::string>& words) const override {
        std::string input, output;
        bool force = false, quiet = false;
        Arguments arguments("import", "Makes a scene of a COLLADA, glTF or OBJ model.");
        arguments.positional("MODEL", input, "a .dae, .gltf, .glb or .obj file");
        arguments.option("-o,--output", "SCENE", output,
                         "the scene; by default named after the model, in the current directory. "
                         "Its meshes lie in a folder beside it, SCENE_files");
        arguments.flag("--force", force, "replaces files that are there");
        arguments.flag("-q,--quiet", quiet, "does not print what became of each thing");
        arguments.footer(
            "Exit codes: 0 success, 1 failure, 2 wrong arguments, 5 file cannot be read or "
            "written.");
        if (const std::optional<int> code = arguments.parse(words)) return *code;
        ignore_write_signals();
        const fs::path model_file(input);
        if (output.empty()) output = model_file.stem().string() + ".xml";
        const fs::path scene_file(output);
        if (scene_file.extension() != ".xml") {
            fmt::print(stderr, "lucerna import: the scene {} must end in .xml\n", output);
            return exit_code::usage;
        }
        Assimp::Importer importer;
        const aiScene& scene = read_model(importer, model_file);
        const fs::path folder = fs::absolute(scene_file).parent_path();
        const bool gltf = lower_extension(model_file).starts_with(".gl");
        const ImportedModel model =
            import_model(scene, {.source = model_file.filename().string(),
                                 .folder = scene_file.stem().string() + "_files",
                                 .model_folder = fs::absolute(model_file).parent_path(),
                                 .scene_folder = fs::absolute(scene_file).parent_path(),
                                 .gltf = gltf});
        const std::string blocked = force ? "" : in_the_way(scene_file, model.files);
        if (!blocked.empty()) {
            throw FileError(fmt::format("{} is there already; --force replaces it", blocked));
        }
        write(scene_file, model);
        if (!quiet) fmt::print("{}", model.account.table());
        fmt::print("{}\n", output);
        return exit_code::success;
    }
};

}  // namespace

const PluginInfo plugin = describe<ImportCommand>("makes a scene of a COLLADA, glTF or OBJ model");

}  // namespace lucerna
