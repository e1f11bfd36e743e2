// SPDX-License-Identifier: Apache-2.0
#include "plugins/commands/import/scene_text.h"

#include <fmt/format.h>

namespace lucerna {

void SceneText::whole(const std::string& name, int value) {
    property("integer", name, std::to_string(value));
}

void SceneText::string(const std::string& name, const std::string& value) {
    property("string", name, escaped(value));
}

void SceneText::rgb(const std::string& name, const aiColor3D& c) {
    property("rgb", name, fmt::format("{}, {}, {}", text(c.r), text(c.g), text(c.b)));
}

void SceneText::point(const std::string& name, const aiVector3D& p) {
    empty(fmt::format(R"(point name="{}" x="{}" y="{}" z="{}")", name, text(p.x), text(p.y),
                      text(p.z)));
}

void SceneText::vector(const std::string& name, const aiVector3D& v) {
    empty(fmt::format(R"(vector name="{}" x="{}" y="{}" z="{}")", name, text(v.x), text(v.y),
                      text(v.z)));
}

void SceneText::lookat(const aiVector3D& origin, const aiVector3D& target, const aiVector3D& up) {
    open(R"(transform name="to_world")");
    empty(fmt::format(R"(lookat origin="{}" target="{}" up="{}")", triple(origin), triple(target),
                      triple(up)));
    close("transform");
}

void SceneText::matrix(const aiMatrix4x4& m) {
    if (m.IsIdentity()) return;
    open(R"(transform name="to_world")");
    std::string values;
    for (unsigned row = 0; row < 4; ++row) {
        for (unsigned column = 0; column < 4; ++column) {
            values += (values.empty() ? "" : " ") + text(m[row][column]);
        }
    }
    empty("matrix value=\"" + values + "\"");
    close("transform");
}

void SceneText::uv_matrix(const aiVector2D& along_u, const aiVector2D& along_v,
                          const aiVector2D& offset) {
    open(R"(transform name="to_uv")");
    empty(fmt::format(R"(matrix value="{} {} {} {} {} {} 0 0 1")", text(along_u.x), text(along_v.x),
                      text(offset.x), text(along_u.y), text(along_v.y), text(offset.y)));
    close("transform");
}

std::string SceneText::text(double value) { return fmt::format("{}", static_cast<float>(value)); }

std::string SceneText::escaped(const std::string& value) {
    std::string result;
    for (const char c : value) {
        switch (c) {
            case '&':
                result += "&amp;";
                break;
            case '<':
                result += "&lt;";
                break;
            case '>':
                result += "&gt;";
                break;
            case '"':
                result += "&quot;";
                break;
            default:
                result += c;
        }
    }
    return result;
}

void SceneText::line(const std::string& content) {
    text_ += std::string(4 * depth_, ' ') + content + "\n";
}

void SceneText::property(const char* type, const std::string& name, const std::string& value) {
    empty(fmt::format(R"({} name="{}" value="{}")", type, name, value));
}

std::string SceneText::triple(const aiVector3D& v) {
    return fmt::format("{}, {}, {}", text(v.x), text(v.y), text(v.z));
}

std::string Names::unique(const std::string& wanted, const std::string& otherwise) {
    std::string name;
    for (const char c : wanted) {
        const bool good = (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') ||
                          (c >= '0' && c <= '9') || c == '_' || c == '-';
        name += good ? c : '_';
    }
    if (name.find_first_not_of('_') == std::string::npos) name = otherwise;
    if (name.size() > 60) name.resize(60);
    std::string candidate = name;
    for (int i = 2; !taken_.insert(candidate).second; ++i) {
        candidate = fmt::format("{}_{}", name, i);
    }
    return candidate;
}

}  // namespace lucerna
