// SPDX-License-Identifier: Apache-2.0
/// Writes materials in the format of the RGL database for tests: tensor files of any fields, and
/// the file of a microfacet model, made as measurements are (Dupuy and Jakob 2018).
#pragma once

#include "core/math/microfacet.h"
#include "plugins/bsdfs/bilinear_tables.h"

#include <cstring>
#include <functional>
#include <map>
#include <string>
#include <vector>

namespace lucerna {

/// A field as its head tells, and bytes, whether they fit together or not.
struct TensorFieldData {
    std::uint8_t type = 10;  ///< float32
    std::vector<std::uint64_t> shape;
    std::vector<std::uint8_t> bytes;
};
using TensorFields = std::map<std::string, TensorFieldData>;

inline TensorFieldData float_field(std::vector<std::uint64_t> shape,
                                   const std::vector<float>& numbers) {
    TensorFieldData field{.shape = std::move(shape), .bytes = {}};
    field.bytes.resize(numbers.size() * sizeof(float));
    if (!numbers.empty()) std::memcpy(field.bytes.data(), numbers.data(), field.bytes.size());
    return field;
}

inline std::vector<std::uint8_t> tensor_bytes(const TensorFields& fields) {
    constexpr char start[] = "tensor_file\0\1";  // and the 0 of the version that ends the text
    std::vector<std::uint8_t> bytes(start, start + sizeof start);
    const auto append = [&](auto number) {
        const auto* const first = reinterpret_cast<const std::uint8_t*>(&number);
        bytes.insert(bytes.end(), first, first + sizeof number);
    };
    append(static_cast<std::uint32_t>(fields.size()));
    std::uint64_t offset = bytes.size();
    for (const auto& [name, field] : fields) {
        offset += 2 + name.size() + 2 + 1 + 8 + 8 * field.shape.size();
    }
    for (const auto& [name, field] : fields) {
        append(static_cast<std::uint16_t>(name.size()));
        bytes.insert(bytes.end(), name.begin(), name.end());
        append(static_cast<std::uint16_t>(field.shape.size()));
        append(field.type);
        append(offset);
        for (const std::uint64_t size : field.shape) append(size);
        offset += field.bytes.size();
    }
    for (const auto& [name, field] : fields) {
        bytes.insert(bytes.end(), field.bytes.begin(), field.bytes.end());
    }
    return bytes;
}

/// A microfacet model of constant reflectance.
struct MicrofacetMaterial {
    Microfacet facets{Microfacet::Type::ggx, 0.3f, 0.3f};
    Color reflectance{1};

    /// With the cosine of wo, but without the density of normals: f cos θo / D.
    double without_normals(Vector3 wi, Vector3 wo) const {
        if (!(wi.z > 0 && wo.z > 0)) return 0;
        return static_cast<double>(0.25f * facets.visibility(wo, wi) * wo.z);
    }
    double f_cos(Vector3 wi, Vector3 wo) const {
        return static_cast<double>(facets.D(glm::normalize(wi + wo))) * without_normals(wi, wo);
    }
};

/// How finely it is measured.
struct MeasuringGrid {
    int phis = 1;      ///< of ωi; 1: isotropic
    int symmetry = 1;  ///< the φ cover this part of a turn, from −π
    int thetas = 9;
    int normals = 32, samples = 32;  ///< side of the tables
    bool spectral = false;           ///< two flat spectra instead of rgb
};

inline TensorFields measured(const MicrofacetMaterial& material, const MeasuringGrid& grid) {
    const auto direction = [](double theta, double phi) {
        return Vector3(Vector3d(std::sin(theta) * std::cos(phi), std::sin(theta) * std::sin(phi),
                                std::cos(theta)));
    };
    const auto theta_at = [](double u) { return 0.5 * std::numbers::pi * u * u; };
    const auto phi_at = [](double u) { return (2 * u - 1) * std::numbers::pi; };
    /// The values of a function at the nodes of the unit square.
    const auto table = [](int side, const std::function<double(double, double)>& f) {
        std::vector<float> numbers;
        for (int i = 0; i < side * side; ++i) {
            const double last = side - 1;
            numbers.push_back(static_cast<float>(f(i % side / last, i / side / last)));
        }
        return numbers;
    };
    std::vector<float> phi_i{0}, theta_i;
    if (grid.phis > 1) {
        phi_i.clear();
        for (int i = 0; i < grid.phis; ++i) {
            const double part = static_cast<double>(i) / (grid.phis - 1) / grid.symmetry;
            phi_i.push_back(static_cast<float>(phi_at(part)));
        }
    }
    for (int i = 0; i < grid.thetas; ++i) {
        theta_i.push_back(static_cast<float>(theta_at(i / (grid.thetas - 1.0))));
    }
    std::vector<float> vndf, luminances, colors;
    const auto append = [](std::vector<float>& to, const std::vector<float>& from) {
        to.insert(to.end(), from.begin(), from.end());
    };
    const Microfacet& facets = material.facets;
    for (const float phi : phi_i) {
        for (const float theta : theta_i) {
            Vector3 wi = direction(static_cast<double>(theta), static_cast<double>(phi));
            wi.z = std::max(wi.z, 1e-5f);
            const double area = static_cast<double>(facets.visible_area(wi));
            const std::vector<float> normals = table(grid.normals, [&](double u, double v) {
                const Vector3 m = direction(theta_at(u), phi_at(v));
                const double density =
                    static_cast<double>(facets.D(m) * std::max(glm::dot(wi, m), 0.0f));
                return density / area * 2 * sqr(std::numbers::pi) * u * std::sin(theta_at(u));
            });
            append(vndf, normals);
            const auto side = static_cast<std::size_t>(grid.normals);
            const BilinearWarp warp(normals, {side, side});
            const TableMix one{.count = 1, .table = {0}, .weight = {1}};
            const std::vector<float> spectra = table(grid.samples, [&](double u, double v) {
                const Vector2d at = warp.sample(one, {u, v});
                const Vector3 wo = reflect(wi, direction(theta_at(at.x), phi_at(at.y)));
                return 4 * area * material.without_normals(wi, wo);
            });
            append(luminances, spectra);
            for (const float channel :
                 {material.reflectance.x, material.reflectance.y, material.reflectance.z}) {
                std::vector<float> scaled = spectra;
                for (float& x : scaled) x *= channel;
                append(colors, scaled);
                if (grid.spectral && colors.size() == 2 * luminances.size()) break;
            }
        }
    }
    const auto phis = phi_i.size(), thetas = theta_i.size();
    const auto n = static_cast<std::uint64_t>(grid.normals);
    const auto s = static_cast<std::uint64_t>(grid.samples);
    TensorFields fields;
    fields["description"] = {.type = 1, .shape = {5}, .bytes = {'f', 'a', 'c', 'e', 't'}};
    fields["jacobian"] = {.type = 1, .shape = {1}, .bytes = {1}};
    fields["phi_i"] = float_field({phis}, phi_i);
    fields["theta_i"] = float_field({thetas}, theta_i);
    fields["vndf"] = float_field({phis, thetas, n, n}, vndf);
    fields["luminance"] = float_field({phis, thetas, s, s}, luminances);
    fields["ndf"] = float_field({n, n}, table(grid.normals, [&](double u, double v) {
                                    const Vector3 m = direction(theta_at(u), phi_at(v));
                                    return static_cast<double>(facets.D(m));
                                }));
    fields["sigma"] = float_field({n, n}, table(grid.normals, [&](double u, double v) {
                                      const Vector3 w = direction(theta_at(u), phi_at(v));
                                      return static_cast<double>(facets.visible_area(w));
                                  }));
    if (grid.spectral) {
        fields["wavelengths"] = float_field({2}, {350, 850});
        fields["spectra"] = float_field({phis, thetas, 2, s, s}, colors);
    } else {
        fields["rgb"] = float_field({phis, thetas, 3, s, s}, colors);
    }
    return fields;
}

}  // namespace lucerna
