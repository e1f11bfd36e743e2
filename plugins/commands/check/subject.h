// SPDX-License-Identifier: Apache-2.0
/// The plugin that is checked, made with its parameters, and placed where it can be tried.
#pragma once

#include "core/scene/builder.h"

#include <filesystem>
#include <memory>
#include <string>
#include <vector>

namespace lucerna {

/// What the command line says of it.
struct SubjectRequest {
    std::string plugin;                 ///< "bsdf/toon"; an id if a scene is given
    std::vector<std::string> settings;  ///< "bands=5"
    std::string inside;                 ///< XML that stands inside of the element
    std::string scene;                  ///< file that has the element, or empty
};

/// An object, with all that it needs to live. The scene may hold it, or be what it is tried in.
struct MadeSubject {
    std::vector<std::unique_ptr<Object>> objects;
    std::unique_ptr<Scene> scene;
    const Object* object = nullptr;
};

class Subject {
public:
    /// Reads it. Throws SceneError with what is wrong with its parameters, Error if there is no
    /// such plugin or element, or no contract for its kind.
    Subject(const SubjectRequest& request, Registry& registry);

    const std::string& kind() const { return element_->kind; }
    const std::string& type() const { return element_->type; }

    /// In a scene with a ball: all but shapes, emitters and light samplers need no more.
    MadeSubject make();
    /// A shape alone.
    MadeSubject make_shape();
    /// An emitter on a rectangle if it wants to be on a surface, else over a ball.
    MadeSubject make_emitter();
    /// A light sampler that is prepared for a scene.
    MadeSubject make_light_sampler(const std::string& scene);

    /// What the author should know of the last one made.
    const std::vector<Diagnostic>& warnings() const { return warnings_; }

private:
    void read_text(const SubjectRequest& request);
    void read_scene_file(const SubjectRequest& request);
    const Object* build(const Element& element, MadeSubject& made);
    Element& add_element(const std::string& kind, const std::string& type);

    Registry& registry_;
    Description description_;
    Element* element_ = nullptr;
    std::vector<Diagnostic> warnings_;
};

}  // namespace lucerna
