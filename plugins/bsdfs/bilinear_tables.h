// SPDX-License-Identifier: Apache-2.0
/// Functions and densities on the unit square that change with two parameters: one table of values
/// for each pair of parameters. Between the nodes of a table and between parameters they are
/// interpolated linearly.
///
/// The densities are warps between uniform random numbers and points: first along y by the marginal
/// density, then along x by the conditional one. Both are linear between nodes, so that maps and
/// densities are exact (Dupuy and Jakob 2018, section 4.3; Mitsuba calls them `Marginal2D`).
#pragma once

#include "core/math/vector.h"

#include <array>
#include <span>
#include <vector>

namespace lucerna {

/// The tables around a pair of parameters, and how much of each.
struct TableMix {
    std::size_t count = 0;
    std::array<std::size_t, 4> table{};
    std::array<double, 4> weight{};

    void add(std::size_t index, double share) {
        if (share == 0) return;
        table[count] = index;
        weight[count++] = share;
    }
};

/// The parameters of tables that lie in rows: `across` changes fastest. Both rise.
struct TableParameters {
    std::vector<float> down, across;

    std::size_t count() const { return down.size() * across.size(); }

    /// Parameters beyond the ends are those of the ends.
    TableMix mix(double down_at, double across_at) const {
        const Place row = place(down, down_at), column = place(across, across_at);
        TableMix result;
        for (const std::size_t i : {0u, 1u}) {
            for (const std::size_t k : {0u, 1u}) {
                result.add((row.index + i) * across.size() + column.index + k,
                           row.share(i) * column.share(k));
            }
        }
        return result;
    }

private:
    struct Place {
        std::size_t index;
        double t;

        double share(std::size_t next) const { return next ? t : 1 - t; }
    };
    static Place place(const std::vector<float>& knots, double x) {
        if (!(x > static_cast<double>(knots.front()))) return {0, 0};
        if (x >= static_cast<double>(knots.back())) return {knots.size() - 1, 0};
        const auto above = std::upper_bound(knots.begin(), knots.end(), x, [](double a, float b) {
            return a < static_cast<double>(b);
        });
        const auto i = static_cast<std::size_t>(above - knots.begin()) - 1;
        const auto low = static_cast<double>(knots[i]), high = static_cast<double>(knots[i + 1]);
        return {i, (x - low) / (high - low)};
    }
};

/// Where the nodes of a table lie: `width` × `height` of them, at least 2 × 2, x fastest.
struct TableShape {
    std::size_t width, height;

    std::size_t count() const { return width * height; }

    /// The node before a coordinate in [0, 1] of `nodes`, and the part of the way to the next.
    struct Place {
        std::size_t node;
        double t;
    };
    static Place place(double x, std::size_t nodes) {
        const auto last = static_cast<double>(nodes - 1);
        const double scaled = std::clamp(x, 0.0, 1.0) * last;
        const auto node = std::min(static_cast<std::size_t>(scaled), nodes - 2);
        return {node, scaled - static_cast<double>(node)};
    }
};

/// A function of points of the unit square: `value(table, node)` tells what it is at the nodes.
template <typename Value, typename Function>
Value interpolate(TableShape shape, const TableMix& mix, Vector2d p, const Function& value) {
    const TableShape::Place x = TableShape::place(p.x, shape.width);
    const TableShape::Place y = TableShape::place(p.y, shape.height);
    const std::size_t first = y.node * shape.width + x.node;
    Value sum(0);
    for (std::size_t i = 0; i < mix.count; ++i) {
        const auto node = [&](std::size_t offset) { return value(mix.table[i], first + offset); };
        const Value low = (1 - x.t) * node(0) + x.t * node(1);
        const Value high = (1 - x.t) * node(shape.width) + x.t * node(shape.width + 1);
        sum += mix.weight[i] * ((1 - y.t) * low + y.t * high);
    }
    return sum;
}

class BilinearWarp {
public:
    /// What a point came from, and its density per area of the unit square.
    struct Inverse {
        Vector2d u;
        double pdf;
    };

    BilinearWarp() = default;
    /// Tables of finite values that are not negative, one after the other. If the values of a
    /// table are all zero, so are its densities.
    BilinearWarp(std::vector<float> values, TableShape shape);

    /// Maps uniform random numbers in [0, 1)² to a point; `mix` must hold a table that is not zero.
    Vector2d sample(const TableMix& mix, Vector2d u) const;
    /// The inverse of `sample` at a point in [0, 1]².
    Inverse invert(const TableMix& mix, Vector2d p) const;

    /// True if all values of a table are zero.
    bool is_zero(std::size_t table) const {
        return !(marginal_[(table + 1) * shape_.height - 1] > 0);
    }
    TableShape shape() const { return shape_; }

private:
    double mixed(const std::vector<float>& numbers, const TableMix& mix, std::size_t stride,
                 std::size_t place) const {
        double sum = 0;
        for (std::size_t i = 0; i < mix.count; ++i) {
            sum += mix.weight[i] * static_cast<double>(numbers[mix.table[i] * stride + place]);
        }
        return sum;
    }
    /// ∫ of the marginal density from 0 to a row.
    double marginal(const TableMix& mix, std::size_t row) const {
        return mixed(marginal_, mix, shape_.height, row);
    }
    /// ∫ of the density from x = 0 to a node, along a row.
    double conditional(const TableMix& mix, std::size_t node) const {
        return mixed(conditional_, mix, shape_.count(), node);
    }
    double value(const TableMix& mix, std::size_t node) const {
        return mixed(values_, mix, shape_.count(), node);
    }

    /// What lies at y = t between a row and the next: of x at a column.
    struct Line {
        double at(double low, double high) const { return low + t * (high - low); }
        double t;
    };

    /// The part t of a segment in which the density rises linearly from a to b that holds `area` of
    /// it, if the whole holds (a + b) / 2.
    static double part_of_segment(double area, double a, double b) {
        const double sum = a + safe_sqrt(a * a + 2 * (b - a) * area);
        return sum > 0 ? std::clamp(2 * area / sum, 0.0, 1.0) : 0.0;
    }
    static double area_of_part(double t, double a, double b) { return t * (a + 0.5 * t * (b - a)); }

    /// The last of `count` segments at whose beginning `cdf` is not above `x`.
    template <typename Cdf>
    static std::size_t segment(std::size_t count, double x, const Cdf& cdf) {
        std::size_t first = 0, last = count - 1;
        while (first < last) {
            const std::size_t middle = (first + last + 1) / 2;
            if (cdf(middle) <= x) {
                first = middle;
            } else {
                last = middle - 1;
            }
        }
        return first;
    }

    TableShape shape_{2, 2};
    std::vector<float> values_;       ///< ∫ over the square is 1
    std::vector<float> conditional_;  ///< cumulative along each row
    std::vector<float> marginal_;     ///< cumulative over the rows
};

inline BilinearWarp::BilinearWarp(std::vector<float> values, TableShape shape)
    : shape_(shape), values_(std::move(values)), conditional_(values_.size()) {
    const std::size_t w = shape.width, h = shape.height, tables = values_.size() / shape.count();
    marginal_.resize(tables * h);
    const double dx = 1 / static_cast<double>(w - 1), dy = 1 / static_cast<double>(h - 1);
    std::vector<double> along(shape.count()), over(h);
    for (std::size_t k = 0; k < tables; ++k) {
        float* const table = &values_[k * shape.count()];
        const auto number = [&](std::size_t node) { return static_cast<double>(table[node]); };
        for (std::size_t y = 0; y < h; ++y) {
            along[y * w] = 0;
            for (std::size_t i = y * w + 1; i < (y + 1) * w; ++i) {
                along[i] = along[i - 1] + 0.5 * dx * (number(i - 1) + number(i));
            }
            const auto row = [&](std::size_t r) { return along[(r + 1) * w - 1]; };
            over[y] = y == 0 ? 0.0 : over[y - 1] + 0.5 * dy * (row(y - 1) + row(y));
        }
        const double total = over.back(), scale = total > 0 ? 1 / total : 0.0;
        const auto scaled = [&](double x) { return static_cast<float>(x * scale); };
        for (std::size_t i = 0; i < shape.count(); ++i) {
            conditional_[k * shape.count() + i] = scaled(along[i]);
            table[i] = scaled(number(i));
        }
        for (std::size_t y = 0; y < h; ++y) marginal_[k * h + y] = scaled(over[y]);
    }
}

inline Vector2d BilinearWarp::sample(const TableMix& mix, Vector2d u) const {
    const std::size_t w = shape_.width, h = shape_.height;
    const auto columns = static_cast<double>(w - 1), rows = static_cast<double>(h - 1);

    const double v = u.y * marginal(mix, h - 1);
    const std::size_t row = segment(h - 1, v, [&](std::size_t y) { return marginal(mix, y); });
    const std::size_t first = row * w, next = first + w;
    const double row0 = conditional(mix, first + w - 1), row1 = conditional(mix, next + w - 1);
    const Line line{part_of_segment((v - marginal(mix, row)) * rows, row0, row1)};

    const double q = u.x * line.at(row0, row1);
    const auto along = [&](std::size_t x) {
        return line.at(conditional(mix, first + x), conditional(mix, next + x));
    };
    const std::size_t column = segment(w - 1, q, along);
    const auto density = [&](std::size_t x) {
        return line.at(value(mix, first + x), value(mix, next + x));
    };
    const double t =
        part_of_segment((q - along(column)) * columns, density(column), density(column + 1));
    return {(static_cast<double>(column) + t) / columns,
            (static_cast<double>(row) + line.t) / rows};
}

inline BilinearWarp::Inverse BilinearWarp::invert(const TableMix& mix, Vector2d p) const {
    const std::size_t w = shape_.width, h = shape_.height;
    const auto columns = static_cast<double>(w - 1), rows = static_cast<double>(h - 1);
    const TableShape::Place x = TableShape::place(p.x, w), y = TableShape::place(p.y, h);
    const std::size_t first = y.node * w, next = first + w;
    const double total = marginal(mix, h - 1);
    if (!(total > 0)) return {Vector2d(0), 0};

    const double row0 = conditional(mix, first + w - 1), row1 = conditional(mix, next + w - 1);
    const double below = marginal(mix, y.node) + area_of_part(y.t, row0, row1) / rows;
    const Line line{y.t};
    const double length = line.at(row0, row1);
    const double a = line.at(value(mix, first + x.node), value(mix, next + x.node));
    const double b = line.at(value(mix, first + x.node + 1), value(mix, next + x.node + 1));
    const double before =
        line.at(conditional(mix, first + x.node), conditional(mix, next + x.node)) +
        area_of_part(x.t, a, b) / columns;
    return {{length > 0 ? std::min(before / length, 1.0) : 0.0, std::min(below / total, 1.0)},
            (a + x.t * (b - a)) / total};
}

}  // namespace lucerna
