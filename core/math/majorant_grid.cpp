// SPDX-License-Identifier: Apache-2.0
#include "core/math/majorant_grid.h"

namespace lucerna {

MajorantIterator::MajorantIterator(const MajorantGrid& grid, Vector3 o, Vector3 d, float tmax)
    : grid_(grid), end_(tmax) {
    const Bounds3& box = grid.bounds();
    for (int i = 0; i < 3; ++i) {
        if (d[i] == 0) {
            if (!(o[i] >= box.min[i] && o[i] <= box.max[i])) end_ = -1;
            continue;
        }
        const float a = (box.min[i] - o[i]) / d[i], b = (box.max[i] - o[i]) / d[i];
        t_ = std::max(t_, std::min(a, b));
        end_ = std::min(end_, std::max(a, b));
    }
    if (!(t_ < end_)) return;
    for (int i = 0; i < 3; ++i) {
        const float place = (o[i] + t_ * d[i] - box.min[i]) / grid.cell()[i];
        at_[i] = std::clamp(static_cast<int>(place), 0, grid.size()[i] - 1);
        if (d[i] == 0) continue;
        step_[i] = d[i] > 0 ? 1 : -1;
        delta_[i] = grid.cell()[i] / std::abs(d[i]);
        const float wall = box.min[i] + static_cast<float>(at_[i] + (d[i] > 0)) * grid.cell()[i];
        next_[i] = (wall - o[i]) / d[i];
    }
}

std::optional<MajorantSegment> MajorantIterator::next() {
    while (t_ < end_) {
        const int axis = next_.x <= next_.y && next_.x <= next_.z ? 0 : next_.y <= next_.z ? 1 : 2;
        const float majorant = grid_[at_];
        const float begin = t_;
        t_ = std::clamp(next_[axis], begin, end_);
        next_[axis] += delta_[axis];
        at_[axis] += step_[axis];
        const bool left = at_[axis] < 0 || at_[axis] >= grid_.size()[axis];
        const float end = t_;
        if (left) end_ = t_;
        if (end > begin && majorant > 0) return MajorantSegment{begin, end, majorant};
    }
    return {};
}

}  // namespace lucerna
