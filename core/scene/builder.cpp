// SPDX-License-Identifier: Apache-2.0
#include "core/scene/builder.h"

#include "core/base/file_bytes.h"
#include "core/base/find_file.h"
#include "core/interfaces/film.h"
#include "core/interfaces/texture.h"
#include "core/math/sequences.h"
#include "core/plugin/build_context.h"
#include "core/scene/preparation_error.h"

#include <fmt/format.h>

#include <map>
#include <optional>
#include <set>

namespace lucerna {

namespace fs = std::filesystem;

namespace {

constexpr int max_nesting = 256;  // by references; the reader bounds nesting in the text

/// ASCII: names of plugins have no other letters.
std::string in_small_letters(std::string text) {
    for (char& c : text) {
        if (c >= 'A' && c <= 'Z') c = static_cast<char>(c - 'A' + 'a');
    }
    return text;
}

class ObjectBuilder final : public BuildContext {
public:
    ObjectBuilder(const Description& description, Registry& registry, Diagnostics& diagnostics,
                  Vector3d origin = Vector3d(0))
        : description_(description),
          registry_(registry),
          diagnostics_(diagnostics),
          origin_(origin),
          asking_(scene_place()),
          hash_(description.hash) {}

    /// The object of an element, built at most once. Null if it is wrong; the reason is recorded.
    Object* build(const Element& element);
    std::vector<std::unique_ptr<Object>> take_objects() { return std::move(objects_); }
    /// Where the elements of these objects are; of a default, who asked for it.
    std::vector<Location> take_places() { return std::move(places_); }

    /// Hash of the description and of the contents of the files that were asked for.
    std::uint64_t hash() const { return hash_; }

    const Object* object(const Child& child) override { return built_.at(child.element); }
    Object* default_object(std::string_view kind, std::string_view type) override;
    fs::path find_file(const std::string& name) override;
    Transform placement(const Element& element) override;
    Diagnostics& diagnostics() override { return diagnostics_; }
    bool lenient() const override { return description_.legacy; }

private:
    bool build_children(const Element& element);
    const PluginInfo* find_plugin(const Element& element);
    Object* construct(const Element& element, const PluginInfo& info, bool complete);
    Object* keep(std::unique_ptr<Object> object, Location where);
    void require_attributes(const Element& element, const Shape* shape);
    Location scene_place() const {
        return description_.root ? description_.root->where : Location();
    }

    const Description& description_;
    Registry& registry_;
    Diagnostics& diagnostics_;
    Vector3d origin_;
    std::vector<std::unique_ptr<Object>> objects_;
    std::vector<Location> places_;
    std::map<const Element*, Object*> built_;
    std::map<std::pair<std::string, std::string>, Object*> defaults_;
    Location asking_;  ///< what is being constructed, or the scene
    std::set<fs::path> hashed_files_;
    std::uint64_t hash_;
    int nesting_ = 0;
    int shapes_around_ = 0;
    bool reads_attributes_ = false;  ///< some texture does
};

/// Constructs a plugin with nothing, to see what it asks for.
class DescribingContext final : public BuildContext {
public:
    explicit DescribingContext(Registry& registry) : builder_(none_, registry, ignored_) {}

    const Object* object(const Child&) override { return nullptr; }
    const Object* default_object(std::string_view kind, std::string_view type) override {
        return builder_.default_object(kind, type);
    }
    fs::path find_file(const std::string&) override { return {}; }
    Transform placement(const Element&) override { return {}; }
    Diagnostics& diagnostics() override { return ignored_; }
    bool describing() const override { return true; }

private:
    Description none_;
    Diagnostics ignored_;
    ObjectBuilder builder_;
};

Object* ObjectBuilder::build(const Element& element) {
    if (const auto known = built_.find(&element); known != built_.end()) return known->second;
    built_[&element] = nullptr;
    if (++nesting_ > max_nesting) {
        diagnostics_.error(element.where,
                           fmt::format("objects are nested more than {} deep", max_nesting));
        --nesting_;
        return nullptr;
    }
    const PluginInfo* const info = find_plugin(element);
    const bool complete = build_children(element) && !element.incomplete;
    // Also if it cannot be used: its own parameters may be wrong, too.
    Object* const object = info ? construct(element, *info, complete) : nullptr;
    --nesting_;
    return built_[&element] = object;
}

const PluginInfo* ObjectBuilder::find_plugin(const Element& element) {
    if (element.type.empty() && element.incomplete) return nullptr;
    const std::string small = in_small_letters(element.type);
    const auto is_there = [&](std::string_view name) {
        return !registry_.path(element.kind, plugin_alias(element.kind, name)).empty();
    };
    const bool misspelled = small != element.type && !is_there(element.type) && is_there(small);
    if (misspelled) {
        diagnostics_.warning(element.where, fmt::format("{} \"{}\" is taken for \"{}\"",
                                                        element.kind, element.type, small));
    }
    try {
        return &registry_.find(element.kind, misspelled ? small : element.type);
    } catch (const PluginError& e) {
        diagnostics_.plugin_error(element.where, e.what());
    } catch (const Error& e) {
        diagnostics_.error(element.where, e.what());
    }
    return nullptr;
}

bool ObjectBuilder::build_children(const Element& element) {
    bool complete = true;
    shapes_around_ += element.kind == Shape::kind ? 1 : 0;
    for (const Child& child : element.children) complete &= build(*child.element) != nullptr;
    shapes_around_ -= element.kind == Shape::kind ? 1 : 0;
    return complete;
}

Object* ObjectBuilder::construct(const Element& element, const PluginInfo& info, bool complete) {
    const int errors_before = diagnostics_.error_count();
    const Params params(element, *this);
    std::unique_ptr<Object> object;
    std::string thrown;
    asking_ = element.where;
    try {
        object.reset(info.create(params));
    } catch (const std::bad_alloc&) {
        thrown = fmt::format("not enough memory for {} \"{}\"", element.kind, element.type);
    } catch (const TransientFileError&) {
        throw;  // no fault of the scene
    } catch (const PluginError& e) {
        diagnostics_.plugin_error(element.where, e.what());
    } catch (const std::exception& e) {
        thrown = e.what();
    }
    asking_ = scene_place();
    if (!thrown.empty() && complete && !params.made_up()) {
        diagnostics_.error(element.where, thrown);
    }
    params.report_unused(
        !object, [&] { return describe_parameters(registry_, element.kind, element.type); });
    if (!object || !complete || diagnostics_.error_count() > errors_before) return nullptr;
    if (const auto* texture = dynamic_cast<const Texture*>(object.get())) {
        reads_attributes_ = reads_attributes_ || !texture->attribute().empty();
    }
    if (reads_attributes_ && element.kind == Shape::kind) {
        require_attributes(element, static_cast<const Shape*>(object.get()));
    }
    if (reads_attributes_ && element.kind == Emitter::kind && shapes_around_ == 0) {
        require_attributes(element, nullptr);
    }
    return keep(std::move(object), element.where);
}

Object* ObjectBuilder::keep(std::unique_ptr<Object> object, Location where) {
    objects_.push_back(std::move(object));
    places_.push_back(where);
    return objects_.back().get();
}

/// Textures in the element must not read attributes that the shape, null if there is none, has not.
void ObjectBuilder::require_attributes(const Element& element, const Shape* shape) {
    for (const Child& child : element.children) {
        if (child.element->kind == Shape::kind) continue;  // has its own
        require_attributes(*child.element, shape);
        const auto* texture = dynamic_cast<const Texture*>(built_[child.element]);
        if (!texture || texture->attribute().empty()) continue;
        const std::string name(texture->attribute());
        if (name == "position") {  // all surfaces have it
            if (shape) continue;
            diagnostics_.error(child.where,
                               fmt::format("texture \"{}\" is looked up where a surface lies, and "
                                           "there is no surface here",
                                           child.element->type));
            continue;
        }
        const std::vector<std::string> known =
            shape ? shape->attributes() : std::vector<std::string>();
        if (std::find(known.begin(), known.end(), name) != known.end()) continue;
        diagnostics_.error(
            child.where,
            !shape ? fmt::format("\"{}\" is an attribute of a mesh, and there is none here", name)
            : known.empty() ? fmt::format("the shape has no attribute \"{}\": it has none", name)
                            : fmt::format("the shape has no attribute \"{}\"; it has {}{}", name,
                                          join(known), did_you_mean(name, known)));
    }
}

Object* ObjectBuilder::default_object(std::string_view kind, std::string_view type) {
    const auto [known, is_new] = defaults_.try_emplace({std::string(kind), std::string(type)});
    if (!is_new) return known->second;
    Element element;
    element.kind = kind;
    element.type = type;
    const Params params(element, *this);
    std::unique_ptr<Object> object(registry_.find(kind, type).create(params));
    return known->second = keep(std::move(object), asking_);
}

fs::path ObjectBuilder::find_file(const std::string& name) {
    const fs::path path = lucerna::find_file(name, description_.search_paths);
    if (hashed_files_.insert(path).second) hash_ = hash_combine(hash_, hash_of_file(path));
    return path;
}

Transform ObjectBuilder::placement(const Element& element) {
    // A shape inside a shape lives in the space of its parent.
    if (element.kind == Shape::kind && shapes_around_ > 0) return {};
    return origin_ == Vector3d(0) ? Transform() : Transform::translate(-origin_);
}

/// All objects of a description, sorted by what they are for, and where they stand.
struct Construction {
    SceneParts parts;
    std::vector<Location> places;  ///< of parts.objects
};

/// Beyond 1e18 Embree's arithmetic overflows, and so do areas in float.
void check_size(const Shape& shape, Location where, Diagnostics& diagnostics) {
    constexpr float limit = 1e18f;
    const Bounds3 bounds = shape.bounds();
    if (bounds.empty()) return;
    const Vector3 farthest = glm::max(absolute(bounds.min), absolute(bounds.max));
    for (int axis = 0; axis < 3; ++axis) {
        if (farthest[axis] < limit) continue;
        diagnostics.error(where, fmt::format("this shape reaches to {} = {:g}; coordinates must "
                                             "lie below {:g}",
                                             "xyz"[axis], farthest[axis], limit));
        return;
    }
}

bool is_in_a_shape(const Element& scene, const Element& element) {
    return std::ranges::any_of(scene.children, [&](const Child& child) {
        return child.element->kind == Shape::kind &&
               std::ranges::any_of(child.element->children,
                                   [&](const Child& inner) { return inner.element == &element; });
    });
}

std::optional<Construction> construct_all(const Description& description, Registry& registry,
                                          Diagnostics& diagnostics, Vector3d origin) {
    ObjectBuilder builder(description, registry, diagnostics, origin);
    SceneParts parts;
    parts.origin = origin;
    for (const Child& child : description.root->children) {
        const std::string& kind = child.element->kind;
        if (kind == Shape::kind) {
            if (auto* shape = static_cast<Shape*>(builder.build(*child.element))) {
                check_size(*shape, child.where, diagnostics);
                parts.shapes.push_back(shape);
            }
        } else if (kind == Emitter::kind) {
            auto* emitter = static_cast<Emitter*>(builder.build(*child.element));
            if (emitter && emitter->on_surface()) {
                // Shapes that refer to it carry it.
                if (is_in_a_shape(*description.root, *child.element)) continue;
                diagnostics.error(child.where, fmt::format("emitter \"{}\" must be inside a shape",
                                                           child.element->type));
            }
            parts.emitters.push_back(emitter);
        } else if (kind == Integrator::kind) {
            if (parts.integrator) {
                diagnostics.error(child.where,
                                  "the scene has a second integrator; it can have only one");
            }
            parts.integrator = static_cast<Integrator*>(builder.build(*child.element));
        } else if (kind == Sensor::kind) {
            if (parts.sensor) {
                diagnostics.warning(child.where,
                                    "the scene has several sensors: the first is used");
                continue;
            }
            parts.sensor = static_cast<Sensor*>(builder.build(*child.element));
        }
        // BSDFs, textures and the like are built when something refers to them.
    }
    for (const Property& property : description.root->properties) {
        diagnostics.error(property.where,
                          fmt::format("a scene has no parameter \"{}\"", property.name));
    }
    if (diagnostics.error_count() > 0) return {};
    const auto or_default = [&]<typename T>(const T*& part) {
        if (part) return;
        part = static_cast<T*>(builder.default_object(T::kind, default_plugin(T::kind)));
        diagnostics.warning(description.root->where,
                            fmt::format("the scene has no {}: the default is used", T::kind));
    };
    or_default(parts.integrator);
    or_default(parts.sensor);
    parts.objects = builder.take_objects();
    parts.hash = builder.hash();
    return Construction{.parts = std::move(parts), .places = builder.take_places()};
}

/// The centre of the scene if float coordinates would be too coarse for its size there.
std::optional<Vector3d> far_center(const std::vector<Shape*>& shapes) {
    Bounds3 bounds;
    for (const Shape* shape : shapes) bounds.include(shape->bounds());
    if (bounds.empty()) return {};
    constexpr float far = 1e3f;
    const Vector3 center = bounds.center();
    if (max_component(absolute(center)) <= far * max_component(bounds.extent())) return {};
    return Vector3d(center);
}

/// Once, at the integrator.
void warn_of_ignored_media(const Scene& scene, const Description& description,
                           Diagnostics& diagnostics) {
    if (!scene.contains_media() || scene.has_media()) return;
    Location where = description.root->where;
    std::string_view type = default_plugin(Integrator::kind);
    for (const Child& child : description.root->children) {
        if (child.element->kind != Integrator::kind) continue;
        where = child.where;
        type = child.element->type;
    }
    diagnostics.warning(where, fmt::format("the media of this scene are left out: \"{}\" renders "
                                           "none; \"volpath\" does",
                                           type));
}

}  // namespace

std::unique_ptr<Scene> build_scene(const Description& description, Registry& registry,
                                   Diagnostics& diagnostics, const BuildOptions& options) {
    if (!description.buildable) diagnostics.throw_if_errors();
    std::optional<Construction> all =
        construct_all(description, registry, diagnostics, Vector3d(0));
    diagnostics.throw_if_errors();
    if (const std::optional<Vector3d> center = far_center(all->parts.shapes)) {
        const Vector3d shift = Vector3d(0) - *center;  // no -0
        diagnostics.warning(description.root->where,
                            fmt::format("the scene is moved by ({:g}, {:g}, {:g}): it is too far "
                                        "from the origin for its size",
                                        shift.x, shift.y, shift.z));
        Diagnostics again;  // says the same once more
        all = construct_all(description, registry, again, *center);
        again.throw_if_errors();
    }
    all->parts.threads = options.threads;
    std::unique_ptr<Scene> scene;
    try {
        scene = std::make_unique<Scene>(std::move(all->parts));
    } catch (const PreparationError& e) {
        diagnostics.error(all->places[e.object()], e.what());
    }
    diagnostics.throw_if_errors();
    warn_of_ignored_media(*scene, description, diagnostics);
    return scene;
}

std::vector<ParameterInfo> describe_parameters(Registry& registry, std::string_view kind,
                                               std::string_view name) {
    const PluginInfo& info = registry.find(kind, name);
    DescribingContext context(registry);
    Element element;
    element.kind = kind;
    element.type = name;
    const Params params(element, context);
    try {
        const std::unique_ptr<Object> ignored(info.create(params));
    } catch (const std::exception&) {
        // It needs something that is not there, after all parameters have been asked for.
    }
    return params.asked();
}

std::unique_ptr<Object> make_object(Registry& registry, std::string_view kind,
                                    std::string_view name) {
    const PluginInfo& info = registry.find(kind, name);
    const Description none;
    Diagnostics diagnostics;
    ObjectBuilder context(none, registry, diagnostics);
    Element element;
    element.kind = kind;
    element.type = name;
    const Params params(element, context);
    return std::unique_ptr<Object>(info.create(params));
}

const Object* build_object(const Element& element, const Description& description,
                           Registry& registry, Diagnostics& diagnostics,
                           std::vector<std::unique_ptr<Object>>& objects) {
    ObjectBuilder builder(description, registry, diagnostics);
    const Object* result = builder.build(element);
    for (auto& object : builder.take_objects()) objects.push_back(std::move(object));
    return result;
}

}  // namespace lucerna
