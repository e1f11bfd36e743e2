// SPDX-License-Identifier: Apache-2.0
/// How much noise the choice of a light makes at single points of a scene, by asking all lights.
///
/// Let f be the estimate that one sample on light l gives of its light towards the viewer (BSDF,
/// radiance, cosine, visibility, over the density of the sample; as luminance), m₁(l) = E f,
/// m₂(l) = E f², and c = Σ m₁. A sampler that draws l with probability P(l) has the variance
///
///     Var(P) = Σ m₂(l) / P(l) − c²
///     the bound, at P ∝ √m₂:  (Σ √m₂)² − c²            (by the inequality of Cauchy and Schwarz)
///
/// so that one evaluation of all lights judges every sampler that tells its probabilities. What
/// remains at the bound is the noise of the samples on the lights. `unoccluded` is P ∝ √m₂ where m₂
/// knows no shadows: the best that looks at geometry alone. For samplers that estimate 1 / P, 1 / P
/// is the mean of the squared weights of a light, of 65,536 draws.
///
/// The m are estimated from two independent, stratified halves A and B of samples; c² is c_A c_B,
/// without bias. In scenes of very many lights only some of them, with probabilities q in
/// proportion to √m₂ without shadows, are tested for shadows, and count 1 / q times (Horvitz and
/// Thompson 1952); where a sum is squared, what that adds, Σ (1 / q − 1) x² / q, is taken away.
#pragma once

#include "core/interfaces/bsdf.h"
#include "core/interfaces/light_sampler.h"
#include "core/interfaces/sensor.h"
#include "core/math/sequences.h"
#include "core/scene/scene.h"

#include <cmath>
#include <cstdint>
#include <optional>
#include <vector>

namespace lucerna {

struct OracleOptions {
    std::uint32_t points = 200;    ///< of each kind
    std::uint32_t samples = 4;     ///< on each light; even
    std::uint32_t tested = 16384;  ///< expected number of lights tested for shadows, at most
    std::uint64_t seed = 0;

    /// Fewer points and samples where there are so many lights that the work would not end soon.
    static OracleOptions for_lights(std::size_t lights, std::uint32_t points);
};

/// A point at which lights are sampled, and from where it is seen.
struct OraclePoint {
    Interaction at;
    Vector3 wo;  ///< world
    Receiver receiver() const { return at.receiver(wo, at.shape->bsdf()->sides()); }
};

/// Up to `count` of them; fewer if paths rarely get so far.
std::vector<OraclePoint> oracle_points(const Scene& scene, int bounces, std::uint32_t count,
                                       std::uint64_t seed);

/// What all lights do at one point.
struct LightMoments {
    struct Entry {
        std::uint32_t light;
        double first, second;  ///< m₁ and m₂
        double weight;         ///< 1 / q
    };
    Receiver at{};
    std::vector<Entry> entries{};  ///< of the lights that reach the point
    double sum = 0;                ///< c
    double square = 0;             ///< c²
    double bound = 0;              ///< least variance
    double unoccluded = 0;         ///< variance of the choice that knows no shadows

    /// Variance of a choice with these probabilities, called for the entries' lights. Lights of
    /// probability zero are left out: their share of c is `lost`.
    template <typename Probability>
    double variance(const Probability& probability, double& lost) const {
        double total = 0, missing = 0;
        for (const Entry& e : entries) {
            const double p = probability(e.light);
            (p > 0 ? total : missing) += p > 0 ? e.weight * e.second / p : e.weight * e.first;
        }
        lost = sum > 0 ? missing / sum : 0;
        return total - square;
    }
    /// Variance of the choices of a light sampler here.
    double variance_of(const LightSampler& sampler, double& lost) const;
};

class LightOracle {
public:
    LightOracle(const Scene& scene, const OracleOptions& options);

    LightMoments evaluate(const OraclePoint& point, std::uint64_t index) const;

private:
    /// Mean of f in both halves of the samples on a light, and of f² in all of them.
    struct Sampled {
        double a = 0, b = 0, second = 0;
    };
    struct Sums {
        double a = 0, b = 0, root = 0, unoccluded = 0, extra_square = 0, extra_root = 0;

        void add(const Sampled& seen, double weight, double unoccluded_probability) {
            a += weight * seen.a;
            b += weight * seen.b;
            root += weight * std::sqrt(seen.second);
            unoccluded += weight * seen.second / unoccluded_probability;
            extra_square += weight * (weight - 1) * seen.a * seen.b;
            extra_root += weight * (weight - 1) * seen.second;
        }
    };

    Sampled sample(const OraclePoint& point, const Receiver& from, std::uint32_t light,
                   std::uint64_t index, bool shadows) const;

    double estimate(const OraclePoint& point, const Receiver& from, const Light& light, Vector2 u,
                    bool shadows) const;

    const Scene& scene_;
    OracleOptions options_;
};

std::vector<LightMoments> evaluate_all(const Scene& scene, const OracleOptions& options,
                                       const std::vector<OraclePoint>& points);

/// How relative variances are spread over the points: means are ruled by a few of them.
struct OracleFigures {
    double mean = 0;                            ///< of values cut at `cut`
    double median = 0, upper = 0, largest = 0;  ///< upper: nine tenths are below
    std::uint32_t blind = 0;  ///< points at which a light that contributes is never drawn
    double lost = 0;          ///< share of all light that is therefore missing

    static constexpr double cut = 1e4;
};

/// The points of one kind. Points that no light reaches are counted and left out.
class OracleKind {
public:
    explicit OracleKind(std::vector<LightMoments> all);

    const std::vector<LightMoments>& moments() const { return moments_; }
    std::uint32_t dark() const { return dark_; }
    OracleFigures bound() const;
    OracleFigures unoccluded() const;
    OracleFigures judge(const LightSampler& sampler) const;

private:
    /// Mean of variance(moments, lost) over c² + (0.05 c̄)²: nearly dark points count for little.
    template <typename Variance>
    OracleFigures figures(const Variance& variance) const;

    std::vector<LightMoments> moments_;
    std::uint32_t dark_ = 0;
    double mean_ = 0;  ///< c̄
};

}  // namespace lucerna
