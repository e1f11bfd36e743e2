// SPDX-License-Identifier: Apache-2.0
/// Makes objects and scenes from fragments of XML.
#pragma once

#include "core/description/xml_reader.h"
#include "core/scene/builder.h"
#include "tests/paths.h"

#include <fmt/format.h>

#include <memory>
#include <string>
#include <vector>

namespace lucerna {

/// Keeps what it has made. Throws SceneError for what is wrong. Files are looked for in `folder`.
class Workshop {
public:
    explicit Workshop(std::filesystem::path folder = ".") : folder_(std::move(folder)) {}

    /// The first element of the fragment: `make<Film>("<film type='hdrfilm'/>")`.
    template <typename T>
    const T& make(const std::string& xml) {
        Diagnostics diagnostics;
        Description& description = read(xml, diagnostics);
        const Object* object = build_object(*description.root->children.front().element,
                                            description, registry_, diagnostics, objects_);
        diagnostics.throw_if_errors();
        said_ = diagnostics;
        return static_cast<const T&>(*object);
    }

    const Scene& make_scene(const std::string& xml) {
        Diagnostics diagnostics;
        scenes_.push_back(build_scene(read(xml, diagnostics), registry_, diagnostics));
        said_ = diagnostics;
        return *scenes_.back();
    }

    /// The messages of the last thing made, one after the other.
    std::string warnings() const {
        std::string text;
        for (const Diagnostic& d : said_.all()) text += d.text() + "\n";
        return text;
    }

    Registry& registry() { return registry_; }

private:
    Description& read(const std::string& xml, Diagnostics& diagnostics) {
        descriptions_.push_back(std::make_unique<Description>(
            read_scene_text("<scene version='3.0.0'>" + xml + "</scene>",
                            (folder_ / "test.xml").string(), {}, diagnostics)));
        diagnostics.throw_if_errors();
        return *descriptions_.back();
    }

    std::filesystem::path folder_;
    Registry registry_;
    Diagnostics said_;
    std::vector<std::unique_ptr<Description>> descriptions_;
    std::vector<std::unique_ptr<Object>> objects_;
    std::vector<std::unique_ptr<Scene>> scenes_;
};

/// The message with which a fragment is refused; empty if it is not.
inline std::string refusal(const std::string& xml, std::filesystem::path folder = ".") {
    try {
        Workshop(std::move(folder)).make<Object>(xml);
        return "";
    } catch (const SceneError& e) {
        return e.what();
    }
}

inline std::string number(const std::string& name, double value) {
    return fmt::format("<float name='{}' value='{}'/>", name, value);
}
inline std::string whole(const std::string& name, std::int64_t value) {
    return fmt::format("<integer name='{}' value='{}'/>", name, value);
}
inline std::string word(const std::string& name, const std::string& value) {
    return fmt::format("<string name='{}' value='{}'/>", name, value);
}

}  // namespace lucerna
