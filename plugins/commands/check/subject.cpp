// SPDX-License-Identifier: Apache-2.0
#include "plugins/commands/check/subject.h"

#include "core/description/overrides.h"
#include "core/description/xml_reader.h"

#include <fmt/format.h>

namespace lucerna {

namespace {

/// Kinds that have contracts which hold for any plugin by itself.
const std::vector<std::string> checked_kinds = {"bsdf",    "light_sampler", "shape",
                                                "emitter", "texture",       "phase",
                                                "sensor",  "sampler",       "rfilter"};

/// The kind of "bsdf/toon", which must have contracts.
std::string kind_of(const std::string& plugin) {
    const std::size_t slash = plugin.find('/');
    if (slash == std::string::npos) {
        throw Error(
            fmt::format("expected a kind and a name, like bsdf/{}, not {}\n"
                        "  kinds are {}",
                        plugin, quote(plugin), join(checked_kinds)));
    }
    const std::string word = plugin.substr(0, slash);
    std::vector<std::string> known = checked_kinds;
    for (const std::string& kind : checked_kinds) {
        known.push_back(plugin_folder(kind));
        if (word == kind || word == known.back()) return kind;
    }
    const auto& all = plugin_kinds();
    const bool exists = std::find(all.begin(), all.end(), word) != all.end();
    throw Error(fmt::format(
        "{} {}{}\n  kinds that can be checked are {}",
        exists ? "there are no contracts to check for kind" : "there is no kind of plugin",
        quote(word), exists ? "" : did_you_mean(word, known), join(checked_kinds)));
}

}  // namespace

Subject::Subject(const SubjectRequest& request, Registry& registry) : registry_(registry) {
    if (request.scene.empty()) {
        read_text(request);
    } else {
        read_scene_file(request);
    }
}

void Subject::read_text(const SubjectRequest& request) {
    const std::string kind = kind_of(request.plugin);
    const std::string name(
        plugin_alias(kind, std::string_view(request.plugin).substr(request.plugin.find('/') + 1)));
    registry_.find(kind, name);  // throws, with what there is
    Diagnostics diagnostics;
    const std::string text =
        fmt::format("<scene version=\"3.0.0\"><{0} type=\"{1}\">\n{2}\n</{0}></scene>", kind, name,
                    request.inside);
    description_ = read_scene_text(text, "--inside", {}, diagnostics);
    diagnostics.throw_if_errors();
    if (description_.root->children.size() != 1) {
        throw Error("--inside must hold what stands inside of one element");
    }
    element_ = description_.root->children.front().element;
    apply_settings(request.settings, "argument", *element_, description_, diagnostics);
    diagnostics.throw_if_errors();
}

void Subject::read_scene_file(const SubjectRequest& request) {
    if (!request.inside.empty()) throw Error("--inside and --scene cannot be given together");
    Diagnostics diagnostics;
    description_ = read_scene(request.scene, {}, diagnostics);
    diagnostics.throw_if_errors();
    std::vector<std::string> ids;
    for (Element& element : description_.elements) {
        if (element.id.empty()) continue;
        ids.push_back(element.id);
        if (element.id == request.plugin) element_ = &element;
    }
    if (!element_) {
        throw Error(fmt::format("{} has no element with the id {}{}\n  {}", request.scene,
                                quote(request.plugin), did_you_mean(request.plugin, ids),
                                ids.empty() ? "no element has an id" : "there are " + join(ids)));
    }
    kind_of(element_->kind + "/" + element_->type);
    apply_settings(request.settings, "argument", *element_, description_, diagnostics);
    diagnostics.throw_if_errors();
}

Element& Subject::add_element(const std::string& kind, const std::string& type) {
    Element& element = description_.elements.emplace_back();
    element.kind = kind;
    element.type = type;
    element.where = element_->where;
    return element;
}

const Object* Subject::build(const Element& element, MadeSubject& made) {
    Diagnostics diagnostics;
    const Object* object =
        build_object(element, description_, registry_, diagnostics, made.objects);
    diagnostics.throw_if_errors();
    warnings_ = diagnostics.all();
    return object;
}

MadeSubject Subject::make() {
    MadeSubject made;
    SceneParts parts;
    build(add_element(Shape::kind, "sphere"), made);
    parts.shapes.push_back(static_cast<Shape*>(made.objects.back().get()));
    made.object = build(*element_, made);
    parts.objects = std::move(made.objects);
    made.scene = std::make_unique<Scene>(std::move(parts));
    return made;
}

MadeSubject Subject::make_shape() {
    MadeSubject made;
    made.object = build(*element_, made);
    SceneParts parts;
    // Nested objects are made first, so the shape itself is the last one.
    parts.shapes.push_back(static_cast<Shape*>(made.objects.back().get()));
    parts.objects = std::move(made.objects);
    const Geometry geometry = parts.shapes[0]->geometry();
    if (std::holds_alternative<InstanceGeometry>(geometry) ||
        std::holds_alternative<GroupGeometry>(geometry)) {
        throw Error(
            fmt::format("shape \"{}\" has no surface of its own: check the shapes in it", type()));
    }
    if (std::holds_alternative<CurveGeometry>(geometry)) {
        throw Error(
            fmt::format("shape \"{}\" is met from outside only: what surfaces promise does "
                        "not hold for curves",
                        type()));
    }
    made.scene = std::make_unique<Scene>(std::move(parts));
    return made;
}

MadeSubject Subject::make_emitter() {
    MadeSubject probe;
    const bool on_surface = static_cast<const Emitter*>(build(*element_, probe))->on_surface();
    MadeSubject made;
    SceneParts parts;
    Element& shape = add_element(Shape::kind, on_surface ? "rectangle" : "sphere");
    if (on_surface) shape.children.push_back({"", element_, element_->where});
    build(shape, made);
    parts.shapes.push_back(static_cast<Shape*>(made.objects.back().get()));
    if (on_surface) {
        made.object = parts.shapes[0]->emitter();
    } else {
        made.object = build(*element_, made);
        parts.emitters.push_back(static_cast<const Emitter*>(made.object));
    }
    parts.objects = std::move(made.objects);
    made.scene = std::make_unique<Scene>(std::move(parts));
    return made;
}

MadeSubject Subject::make_light_sampler(const std::string& scene) {
    Diagnostics diagnostics;
    const Description description = read_scene_text("<scene version='3.0.0'>" + scene + "</scene>",
                                                    "lights.xml", {}, diagnostics);
    MadeSubject made;
    made.scene = build_scene(description, registry_, diagnostics);
    made.object = build(*element_, made);
    for (const auto& object : made.objects) object->prepare(*made.scene);
    return made;
}

}  // namespace lucerna
