// SPDX-License-Identifier: Apache-2.0
/// Shapes from text, in a scene that rays can be shot into.
#pragma once

#include "core/description/xml_reader.h"
#include "core/scene/builder.h"

#include <memory>
#include <string>
#include <vector>

namespace lucerna {

/// A scene of nothing but the shapes in `xml`. File names in it should be absolute. Throws
/// SceneError.
class World {
public:
    explicit World(const std::string& xml) {
        const Description description = read_scene_text(
            "<scene version='3.0.0'>" + xml + "</scene>", "world.xml", {}, diagnostics_);
        diagnostics_.throw_if_errors();
        SceneParts parts;
        for (const Child& child : description.root->children) {
            if (child.element->kind != Shape::kind) continue;
            build_object(*child.element, description, registry_, diagnostics_, parts.objects);
            diagnostics_.throw_if_errors();
            // Nested objects are made first, so the shape itself is the last one.
            parts.shapes.push_back(static_cast<Shape*>(parts.objects.back().get()));
        }
        parts.threads = 1;
        scene_ = std::make_unique<Scene>(std::move(parts));
    }

    const Scene& scene() const { return *scene_; }
    const Shape& shape() const { return *scene_->shapes().back(); }
    const Diagnostics& diagnostics() const { return diagnostics_; }

private:
    Registry registry_;
    Diagnostics diagnostics_;
    std::unique_ptr<Scene> scene_;
};

/// The message with which a scene of this shape is refused, without the excerpt of the source;
/// empty if it is not.
inline std::string refusal(const std::string& xml) {
    try {
        World world(xml);
        return "";
    } catch (const SceneError& error) {
        std::string all;
        for (const Diagnostic& d : error.diagnostics()) {
            all += (all.empty() ? "" : "\n") + d.message;
        }
        return all;
    }
}

}  // namespace lucerna
