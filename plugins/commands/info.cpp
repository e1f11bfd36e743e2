// SPDX-License-Identifier: Apache-2.0
/// info: what a scene holds and loads, what an image file holds, with its metadata, or a file of a
/// volume.
#include "core/base/json.h"
#include "core/command_line/arguments.h"
#include "core/description/xml_reader.h"
#include "core/image/exr.h"
#include "core/image/read_image.h"
#include "core/interfaces/command.h"
#include "core/interfaces/volume.h"
#include "core/render/session.h"
#include "core/scene/builder.h"

#include <fmt/format.h>

#include <algorithm>
#include <filesystem>

namespace lucerna {

namespace {

namespace fs = std::filesystem;

/// Numbers of things in a scene. What is instanced is counted once.
struct Census {
    std::size_t shapes = 0, triangles = 0, parallelograms = 0, analytic = 0, instances = 0;

    void count(const Shape& shape) {
        ++shapes;
        const Geometry geometry = shape.geometry();
        if (const auto* mesh = std::get_if<TriangleGeometry>(&geometry)) {
            triangles += mesh->indices.size() / 3;
        } else if (const auto* group = std::get_if<GroupGeometry>(&geometry)) {
            --shapes;
            for (const Shape* member : group->shapes) count(*member);
        } else if (const auto* quads = std::get_if<ParallelogramGeometry>(&geometry)) {
            parallelograms += quads->list.size();
        } else if (std::holds_alternative<InstanceGeometry>(geometry)) {
            ++instances;
        } else {
            ++analytic;
        }
    }
};

std::string mebibytes(std::uint64_t bytes) {
    return fmt::format("{:.1f} MiB", static_cast<double>(bytes) / (1 << 20));
}

std::string text(Vector3 v) { return fmt::format("({:g}, {:g}, {:g})", v.x, v.y, v.z); }

/// The shapes of the world, and the groups that its instances show, each once.
Census take_census(const Scene& scene) {
    Census census;
    std::vector<const Shape*> groups;
    for (const Shape* shape : scene.shapes()) {
        census.count(*shape);
        const Geometry geometry = shape->geometry();
        const auto* instance = std::get_if<InstanceGeometry>(&geometry);
        if (!instance) continue;
        if (std::find(groups.begin(), groups.end(), instance->group) != groups.end()) continue;
        groups.push_back(instance->group);
        census.count(*instance->group);
    }
    return census;
}

/// Patches of an environment map are lights, too.
std::size_t lights_at_infinity(const Scene& scene) {
    std::size_t count = 0;
    for (const std::uint32_t first : scene.infinite_lights()) {
        count += scene.lights()[first].emitter->light_count();
    }
    return count;
}

Json scene_json(const Session& session, const std::string& path) {
    const Scene& scene = session.scene();
    const Census census = take_census(scene);
    const CropWindow crop = scene.sensor().film().crop();
    Json json = Json::object();
    json.set("schema", 1).set("scene", path).set("hash", fmt::format("{:016x}", scene.hash()));
    json.set("width", crop.size.x).set("height", crop.size.y);
    json.set("sample_count", scene.sensor().sampler().sample_count());
    json.set("shapes", census.shapes).set("triangles", census.triangles);
    json.set("parallelograms", census.parallelograms).set("analytic", census.analytic);
    json.set("instances", census.instances);
    json.set("lights", scene.lights().size());
    json.set("lights_at_infinity", lights_at_infinity(scene));
    json.set("accelerator_bytes", scene.accelerator_bytes());
    json.set("peak_memory_bytes", peak_memory());
    json.set("plugins", session.registry().opened());
    json.set("layers", scene.integrator().layers());
    return json;
}

void print_scene(const Session& session, const std::string& path) {
    const Scene& scene = session.scene();
    const Census census = take_census(scene);
    const Film& film = scene.sensor().film();
    const CropWindow crop = film.crop();
    fmt::print("{}: scene {:016x}\n", path, scene.hash());
    fmt::print("image       {} × {}", film.size().x, film.size().y);
    if (crop.size != film.size()) {
        fmt::print(", of which {} × {} at ({}, {}) are rendered", crop.size.x, crop.size.y,
                   crop.offset.x, crop.offset.y);
    }
    fmt::print(", {} samples per pixel\n", scene.sensor().sampler().sample_count());
    fmt::print("shapes      {}: {} triangles, {} parallelograms, {} analytic, {} instances\n",
               census.shapes, census.triangles, census.parallelograms, census.analytic,
               census.instances);
    fmt::print("lights      {}, {} of them at infinity\n", scene.lights().size(),
               lights_at_infinity(scene));
    fmt::print("bounds      {} to {}\n", text(scene.bounds().min), text(scene.bounds().max));
    fmt::print("accelerator {}\n", mebibytes(scene.accelerator_bytes()));
    fmt::print("memory      {} at most\n", mebibytes(peak_memory()));
    fmt::print("plugins     {}\n", join(session.registry().opened()));
}

int scene_info(const SessionSettings& settings, bool json) {
    const Session session(settings);
    for (const Diagnostic& warning : session.warnings()) {
        fmt::print(stderr, "{}\n", warning.text());
    }
    if (json) {
        fmt::print("{}", scene_json(session, settings.scene.string()).text());
    } else {
        print_scene(session, settings.scene.string());
    }
    return exit_code::success;
}

std::string type_of(const Plane& plane) {
    if (std::holds_alternative<std::vector<std::uint32_t>>(plane.samples)) return "uint";
    return plane.half ? "half" : "float";
}

Json exr_json(const ImageFile& file, const std::string& path) {
    Json json = Json::object();
    json.set("schema", 1).set("image", path);
    json.set("width", file.width).set("height", file.height).set("x", file.x).set("y", file.y);
    json.set("full_width", file.full_width).set("full_height", file.full_height);
    Json channels = Json::array();
    for (const Plane& plane : file.planes) {
        channels.append(Json::object().set("name", plane.name).set("type", type_of(plane)));
    }
    json.set("channels", channels);
    Json metadata = Json::object();
    for (const auto& entry : file.metadata) {
        std::visit([&](const auto& value) { metadata.set(entry.first, value); }, entry.second);
    }
    return json.set("metadata", metadata);
}

void print_exr(const ImageFile& file, const std::string& path) {
    fmt::print("{}: {} × {}", path, file.width, file.height);
    if (file.full_width > 0 && (file.full_width != file.width || file.full_height != file.height)) {
        fmt::print(" at ({}, {}) of {} × {}", file.x, file.y, file.full_width, file.full_height);
    }
    fmt::print("\n");
    for (const Plane& plane : file.planes) {
        fmt::print("  {} ({})\n", plane.name, type_of(plane));
    }
    if (file.metadata.contains("lucerna:state")) fmt::print("  the state of a render\n");
    for (const auto& entry : file.metadata) {
        std::visit([&](const auto& value) { fmt::print("{} = {}\n", entry.first, value); },
                   entry.second);
    }
}

int image_info(const std::string& path, bool json) {
    if (fs::path(path).extension() == ".exr") {
        const ImageFile file = read_exr(path);
        if (json) {
            fmt::print("{}", exr_json(file, path).text());
        } else {
            print_exr(file, path);
        }
        return exit_code::success;
    }
    const Image image = read_image(path);
    if (json) {
        Json object = Json::object();
        object.set("schema", 1).set("image", path).set("width", image.width);
        object.set("height", image.height).set("channels", image.channels);
        fmt::print("{}", object.text());
    } else {
        fmt::print("{}: {} × {}, channels {}\n", path, image.width, image.height,
                   join(image.channels));
    }
    return exit_code::success;
}

/// The plugin that reads a volume file, by its extension; empty if it is none.
std::string volume_plugin(const fs::path& path) {
    const fs::path extension = path.extension();
    if (extension == ".vol") return "gridvolume";
    if (extension == ".vdb") return "openvdb";
    return extension == ".nvdb" ? "nanovdb" : "";
}

int volume_info(const SessionSettings& settings, const std::string& plugin, const std::string& grid,
                bool json) {
    // Names are filled in after the text is read: they may hold any character.
    ReadOptions options;
    options.defines = {{"file", fs::absolute(settings.scene).string()}};
    std::string xml = "<scene version='3.0.0'><volume type='" + plugin +
                      "'><string name='filename' value='$file'/>";
    if (!grid.empty()) {
        options.defines.emplace_back("grid", grid);
        xml += "<string name='grid' value='$grid'/>";
    }
    Diagnostics diagnostics;
    const Description description =
        read_scene_text(xml + "</volume></scene>", settings.scene.string(), options, diagnostics);
    diagnostics.throw_if_errors();
    Registry registry(settings.plugin_folders);
    std::vector<std::unique_ptr<Object>> objects;
    const auto& volume = static_cast<const Volume&>(*build_object(
        *description.root->children.front().element, description, registry, diagnostics, objects));
    diagnostics.throw_if_errors();
    const Bounds3 bounds = volume.bounds();
    const glm::ivec3 n = volume.resolution();
    if (json) {
        const auto array = [](Vector3 v) {
            return Json::array().append(v.x).append(v.y).append(v.z);
        };
        fmt::print("{}", Json::object()
                             .set("schema", 1)
                             .set("volume", settings.scene.string())
                             .set("resolution", Json::array().append(n.x).append(n.y).append(n.z))
                             .set("min", array(bounds.min))
                             .set("max", array(bounds.max))
                             .set("largest", volume.max(bounds))
                             .text());
    } else {
        fmt::print("{}: {} × {} × {} voxels\n", settings.scene.string(), n.x, n.y, n.z);
        fmt::print("bounds   {} to {}\n", text(bounds.min), text(bounds.max));
        fmt::print("largest  {:g}\n", volume.max(bounds));
    }
    return exit_code::success;
}

class InfoCommand final : public Command {
public:
    explicit InfoCommand(const Params&) {}

    int run(const std::vector<std::string>& words) const override {
        std::string path;
        bool json = false;
        SessionSettings settings;
        std::vector<std::string> folders;
        std::string grid;
        Arguments arguments("info", "Tells what a scene, an image or a volume file holds.");
        arguments.positional("FILE", path,
                             "a scene (XML), an EXR, Radiance, PNG or JPEG file, or a volume (vol, "
                             "vdb, nvdb)");
        arguments.option("--grid", "NAME", grid, "a grid of a file of sparse grids");
        arguments.option("-D,--define", "NAME=VALUE", settings.defines,
                         "value of $NAME in the scene; may be repeated");
        arguments.option("--set", "PATH=VALUE", settings.overrides,
                         "changes the scene; may be repeated");
        arguments.option("--plugins", "DIR", folders,
                         "looks for plugins in DIR first; may be repeated");
        arguments.flag("--json", json, "prints JSON");
        if (const std::optional<int> code = arguments.parse(words)) return *code;
        settings.plugin_folders.assign(folders.begin(), folders.end());
        settings.scene = path;
        if (settings.scene.extension() == ".xml") return scene_info(settings, json);
        const std::string plugin = volume_plugin(settings.scene);
        return plugin.empty() ? image_info(path, json) : volume_info(settings, plugin, grid, json);
    }
};

}  // namespace

const PluginInfo plugin =
    describe<InfoCommand>("tells what a scene, an image or a volume file holds");

}  // namespace lucerna
