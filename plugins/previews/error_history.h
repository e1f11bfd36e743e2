// SPDX-License-Identifier: Apache-2.0
/// How the error of a render has fallen, in a bounded number of points.
#pragma once

#include "core/base/json.h"
#include "core/render/render_job.h"

#include <cstddef>
#include <vector>

namespace lucerna {

class ErrorHistory {
public:
    static constexpr std::size_t most_points = 400;

    /// Takes the error of a status, if it is a new one.
    void add(const RenderStatus& status) {
        if (!status.error) return;
        const double error = status.error->relative_mse;
        if (!points_.empty() && points_.back().error == error) return;
        points_.push_back({status.seconds, error});
        if (points_.size() <= most_points) return;
        // Every second of the older half: what is new stays fine.
        std::vector<Point> kept;
        for (std::size_t i = 0; i < points_.size(); ++i) {
            if (i % 2 == 0 || i > points_.size() / 2) kept.push_back(points_[i]);
        }
        points_ = std::move(kept);
    }
    std::size_t size() const { return points_.size(); }
    /// [[seconds, relMSE], …]
    Json json() const {
        Json list = Json::array();
        for (const Point& point : points_) {
            list.append(std::vector<double>{point.seconds, point.error});
        }
        return list;
    }

private:
    struct Point {
        double seconds, error;
    };
    std::vector<Point> points_;
};

}  // namespace lucerna
