// SPDX-License-Identifier: Apache-2.0
/// ꟻLIP: how different two images look when one flips between them.
/// P. Andersson, J. Nilsson, T. Akenine-Möller, M. Oskarsson, K. Åström, M. D. Fairchild, "ꟻLIP: A
/// Difference Evaluator for Alternating Images", Proc. ACM CGIT 3(2) (HPG 2020). The version for
/// displays (LDR); written from the paper's formulas.
#pragma once

#include <cstddef>

#include "core/image/image.h"

namespace lucerna {

/// A display 0.7 m wide with 3840 pixels, seen from 0.7 m.
inline constexpr double flip_pixels_per_degree = 67.0206432765823;

struct Flip {
    double mean = 0;             ///< over the pixels that are finite in both images, in [0, 1]
    double mean_all = 0;         ///< over all pixels; those that are not finite count as 1
    std::size_t non_finite = 0;  ///< pixels that are not finite in one of the images
    Image map{};                 ///< channel "Y", in [0, 1]; 1 where not finite
};

/// Compares two linear images as an sRGB display shows them: times 2^exposure, clamped to [0, 1].
/// Values that are not finite are shown as black to their neighbours. Throws Error if the sizes
/// differ or unless 1 ≤ pixels_per_degree ≤ 1000.
Flip flip(const Image& image, const Image& reference,
          double pixels_per_degree = flip_pixels_per_degree, double exposure = 0);

}  // namespace lucerna
