// SPDX-License-Identifier: Apache-2.0
/// Writing a scene: elements, numbers and names.
#pragma once

#include <assimp/types.h>

#include <cstddef>
#include <set>
#include <string>

namespace lucerna {

/// Text of a scene file, indented.
class SceneText {
public:
    void open(const std::string& element) { line("<" + element + ">"), ++depth_; }
    void close(const std::string& name) { --depth_, line("</" + name + ">"); }
    void empty(const std::string& element) { line("<" + element + "/>"); }
    void comment(const std::string& text) { line("<!-- " + text + " -->"); }

    void number(const std::string& name, double value) { property("float", name, text(value)); }
    void whole(const std::string& name, int value);
    void string(const std::string& name, const std::string& value);
    void rgb(const std::string& name, const aiColor3D& c);
    void point(const std::string& name, const aiVector3D& p);
    void vector(const std::string& name, const aiVector3D& v);
    void lookat(const aiVector3D& origin, const aiVector3D& target, const aiVector3D& up);
    void matrix(const aiMatrix4x4& m);

    /// The parameter `to_uv` of a texture, by the images of (1, 0) and (0, 1) without the offset.
    void uv_matrix(const aiVector2D& along_u, const aiVector2D& along_v, const aiVector2D& offset);

    const std::string& str() const { return text_; }

    /// The shortest text that is read as the same float.
    static std::string text(double value);

    static std::string escaped(const std::string& value);

private:
    void line(const std::string& content);
    void property(const char* type, const std::string& name, const std::string& value);
    static std::string triple(const aiVector3D& v);

    std::string text_;
    std::size_t depth_ = 0;
};

/// Names that are good for ids and files, and differ.
class Names {
public:
    std::string unique(const std::string& wanted, const std::string& otherwise);

private:
    std::set<std::string> taken_;
};

}  // namespace lucerna
