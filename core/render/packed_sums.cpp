// SPDX-License-Identifier: Apache-2.0
#include "core/render/packed_sums.h"

#include "core/base/vectorized.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstring>
#include <optional>
#include <span>

namespace lucerna {

namespace {

__extension__ using Wide = unsigned __int128;

constexpr std::size_t group_size = 64;
/// The lower bits of an integer, and those above: each part is exact as a double.
constexpr int low_bits = 48;
constexpr int most_bits = low_bits + 53;

/// What precedes the integers of a group.
struct GroupHead {
    std::int16_t unit = 0;       ///< exponent of two
    std::uint8_t bits = 0;       ///< of each integer; `doubles`: the sums are pairs of doubles
    std::uint8_t is_signed = 0;  ///< a bit more for each: the sign
};
static_assert(sizeof(GroupHead) == 4);
constexpr std::uint8_t doubles = 255;
/// The integers of a group, and what a reader may read beyond them.
using GroupBytes = std::array<std::uint8_t, group_size * sizeof(ExactSum) + sizeof(std::uint64_t)>;

/// |x| = mantissa · 2^exponent, with an odd mantissa unless x is 0.
struct Binary {
    std::uint64_t mantissa = 0;
    int exponent = 0;

    explicit Binary(double x) {
        if (x == 0) return;
        const auto bits = std::bit_cast<std::uint64_t>(x);
        const int biased = static_cast<int>(bits >> 52 & 0x7ff);
        mantissa = (bits & 0xfffffffffffffu) | (biased > 0 ? std::uint64_t{1} << 52 : 0);
        const int zeros = std::countr_zero(mantissa);
        mantissa >>= zeros;
        exponent = std::max(biased, 1) - 1075 + zeros;
    }
    int end() const { return exponent + static_cast<int>(std::bit_width(mantissa)); }
};

/// The exponent and the bits with which all sums are integers; nothing if they are too long.
std::optional<GroupHead> common_head(std::span<const ExactSum> sums) {
    int unit = 1 << 14, end = -(1 << 14);
    bool negative = false;
    for (const ExactSum& sum : sums) {
        if (!std::isfinite(sum.high) || !std::isfinite(sum.low)) return {};
        for (const double x : {sum.high, sum.low}) {
            if (x == 0) continue;
            const Binary binary(x);
            unit = std::min(unit, binary.exponent);
            end = std::max(end, binary.end());
        }
        negative = negative || sum.high < 0;
    }
    if (end < unit) return GroupHead{};
    // Low parts can carry into a bit above the highest one.
    const int bits = end + 1 - unit;
    if (bits > most_bits) return {};
    return GroupHead{.unit = static_cast<std::int16_t>(unit),
                     .bits = static_cast<std::uint8_t>(bits),
                     .is_signed = negative};
}

/// |sum| / 2^unit.
Wide magnitude(const ExactSum& sum, int unit) {
    const Binary high(sum.high), low(sum.low);
    const Wide h = Wide{high.mantissa} << (high.mantissa ? high.exponent - unit : 0);
    const Wide l = Wide{low.mantissa} << (low.mantissa ? low.exponent - unit : 0);
    return (sum.low < 0) == (sum.high < 0) ? h + l : h - l;
}

/// Little-endian bits, at most 57 at once. Writes up to 8 bytes beyond them.
class BitWriter {
public:
    explicit BitWriter(std::uint8_t* bytes) : bytes_(bytes) {}
    void put(std::uint64_t bits, int count) {
        waiting_ |= bits << count_;
        std::memcpy(bytes_, &waiting_, sizeof waiting_);
        count_ += count;
        bytes_ += count_ >> 3;
        waiting_ = count_ >= 64 ? 0 : waiting_ >> (count_ & ~7);
        count_ &= 7;
    }

private:
    std::uint8_t* bytes_;
    std::uint64_t waiting_ = 0;
    int count_ = 0;  ///< bits that wait for the rest of their byte
};

std::size_t bytes_of_group(const GroupHead& head, std::size_t count) {
    if (head.bits == doubles) return count * sizeof(ExactSum);
    return (count * (std::size_t{head.bits} + head.is_signed) + 7) / 8;
}

using FourWords = std::uint64_t __attribute__((vector_size(32)));

/// Where the bits of four integers begin, counted from a byte.
struct BitPlaces {
    std::array<std::size_t, 4> byte;
    FourWords bit;  ///< first bit in that byte

    BitPlaces(std::size_t width, std::size_t first) {
        for (std::size_t i = 0; i < 4; ++i) {
            byte[i] = (first + i * width) >> 3;
            bit[i] = (first + i * width) & 7;
        }
    }
};

// Vectors are handed over by reference: by value, how depends on the processor.

/// 57 bits, at least, from each place on; reads 8 bytes.
inline void bits_at(const std::uint8_t* bytes, const BitPlaces& places, FourWords& bits) {
    std::array<std::uint64_t, 4> words;
    for (std::size_t i = 0; i < 4; ++i) {
        std::memcpy(&words[i], bytes + places.byte[i], sizeof words[i]);
    }
    bits = FourWords{words[0], words[1], words[2], words[3]} >> places.bit;
}

/// Integers below 2⁵² as doubles, without the conversion that most processors have for single
/// numbers only.
inline void to_doubles(const FourWords& integers, FourDoubles& result) {
    constexpr std::uint64_t two_to_52 = 0x4330000000000000u;
    const FourWords bits = integers | two_to_52;
    std::memcpy(&result, &bits, sizeof result);
    result -= std::bit_cast<double>(two_to_52);
}

inline void change_signs(const FourWords& negative, FourDoubles& numbers) {
    FourWords bits;
    std::memcpy(&bits, &numbers, sizeof bits);
    bits ^= negative;
    std::memcpy(&numbers, &bits, sizeof numbers);
}

/// How the integers of a group become sums.
class GroupReader {
public:
    explicit GroupReader(const GroupHead& head)
        : low_(std::min<int>(head.bits, low_bits)),
          sign_(head.is_signed),
          low_mask_((std::uint64_t{1} << low_) - 1),
          high_mask_((std::uint64_t{1} << (head.bits - low_)) - 1),
          long_(head.bits - low_ > 52),
          low_unit_(std::ldexp(1.0, head.unit)),
          high_unit_(std::ldexp(1.0, head.unit + low_bits)) {}

    /// Where the upper parts begin, in an integer.
    std::size_t high_begin() const { return sign_ + static_cast<std::size_t>(low_); }

    /// `begin` and `upper` are the bits from the beginning and from high_begin() on.
    inline void read(const FourWords& begin, const FourWords& upper, FourExactSums& sums) const {
        const FourWords high = upper & high_mask_, low = begin >> sign_ & low_mask_;
        FourDoubles most, rest;
        if (long_) {
            FourDoubles last;
            to_doubles(high >> 1, most);
            to_doubles(high & 1, last);
            most = most * 2.0 + last;
        } else {
            to_doubles(high, most);
        }
        to_doubles(low, rest);
        const FourDoubles a = most * high_unit_, b = rest * low_unit_;
        sums.high = a + b;
        sums.low = b - (sums.high - a);
        const FourWords negative = (begin & sign_) << 63;
        change_signs(negative, sums.high);
        change_signs(negative, sums.low);
    }

private:
    int low_;
    std::uint64_t sign_, low_mask_, high_mask_;
    bool long_;  ///< upper parts have 53 bits, more than to_doubles takes
    double low_unit_, high_unit_;
};

// A false alarm of GCC 12 on vectors that are made of four numbers.
#if defined(__GNUC__) && !defined(__clang__)
#pragma GCC diagnostic push
#pragma GCC diagnostic ignored "-Wuninitialized"
#pragma GCC diagnostic ignored "-Wmaybe-uninitialized"
#endif

/// Adds terms to four sums. As ExactSum::add for high and low parts one after the other, which has
/// the same result wherever that is exact: the low parts together have no more bits than one.
inline void add_four(const FourExactSums& terms, SumsOf<ExactSum> sums) {
    ExactSum &a = sums[0], &b = sums[1], &c = sums[2], &d = sums[3];
    FourExactSums all = {.high = {a.high, b.high, c.high, d.high},
                         .low = {a.low, b.low, c.low, d.low}};
    const FourDoubles sum = all.high + terms.high, part = sum - all.high;
    const FourDoubles error = (all.high - (sum - part)) + (terms.high - part);
    const FourDoubles small = (all.low + terms.low) + error;
    all.high = sum + small;
    all.low = small - (all.high - sum);
    a = {all.high[0], all.low[0]};
    b = {all.high[1], all.low[1]};
    c = {all.high[2], all.low[2]};
    d = {all.high[3], all.low[3]};
}

/// Adds the integers that lie at `bytes` to the sums of a whole group; reads 8 bytes beyond them.
LUCERNA_VECTORIZED void add_integers(const GroupHead& head, const std::uint8_t* bytes,
                                     SumsOf<ExactSum> sums) {
    const GroupReader reader(head);
    const std::size_t width = std::size_t{head.bits} + head.is_signed;
    // Eight integers have as many bytes as one has bits.
    const BitPlaces even(width, 0), odd(width, 4 * width);
    const BitPlaces even_upper(width, reader.high_begin());
    const BitPlaces odd_upper(width, 4 * width + reader.high_begin());
    FourWords begin, upper;
    FourExactSums terms;
    for (std::size_t i = 0; i < group_size; i += 8, bytes += width) {
        bits_at(bytes, even, begin);
        bits_at(bytes, even_upper, upper);
        reader.read(begin, upper, terms);
        add_four(terms, sums.part(i, 4));
        bits_at(bytes, odd, begin);
        bits_at(bytes, odd_upper, upper);
        reader.read(begin, upper, terms);
        add_four(terms, sums.part(i + 4, 4));
    }
}

/// Adds terms, one to each sum; their number is a multiple of four.
LUCERNA_VECTORIZED void add_fours(const ExactSum* terms, SumsOf<ExactSum> sums) {
    for (std::size_t i = 0; i < sums.count; i += 4) {
        const ExactSum* const t = terms + i;
        const FourExactSums four = {.high = {t[0].high, t[1].high, t[2].high, t[3].high},
                                    .low = {t[0].low, t[1].low, t[2].low, t[3].low}};
        add_four(four, sums.part(i, 4));
    }
}

#if defined(__GNUC__) && !defined(__clang__)
#pragma GCC diagnostic pop
#endif

/// The same for a group that may not be whole.
void add_some_integers(const GroupHead& head, const std::uint8_t* bytes, SumsOf<ExactSum> sums) {
    if (head.bits == 0) return;
    if (sums.count == group_size) return add_integers(head, bytes, sums);
    std::array<ExactSum, group_size> whole{};
    for (std::size_t i = 0; i < sums.count; ++i) whole[i] = sums[i];
    add_integers(head, bytes, {.first = whole.data(), .count = whole.size()});
    for (std::size_t i = 0; i < sums.count; ++i) sums[i] = whole[i];
}

void add_doubles(const std::uint8_t* bytes, SumsOf<ExactSum> sums) {
    for (std::size_t i = 0; i < sums.count; ++i) {
        ExactSum sum;
        std::memcpy(&sum, bytes + i * sizeof sum, sizeof sum);
        const bool is_zero = sums[i].high == 0 && sums[i].low == 0;
        if (is_zero) {
            sums[i] = sum;
        } else {
            sums[i].add(sum);
        }
    }
}

struct Group {
    GroupHead head;
    std::span<const std::uint8_t> bytes;  ///< behind the head
};

/// The group of so many sums at the front of `rest`, which is taken away; nothing if there is none.
std::optional<Group> take_group(std::span<const std::uint8_t>& rest, std::size_t count) {
    Group group;
    if (rest.size() < sizeof group.head) return {};
    std::memcpy(&group.head, rest.data(), sizeof group.head);
    const GroupHead& head = group.head;
    if ((head.bits > most_bits && head.bits != doubles) || head.is_signed > 1) return {};
    const std::size_t size = bytes_of_group(head, count);
    if (rest.size() - sizeof head < size) return {};
    group.bytes = rest.subspan(sizeof head, size);
    rest = rest.subspan(sizeof head + size);
    return group;
}

void put_integers(const GroupHead& head, std::span<const ExactSum> sums, GroupBytes& bytes) {
    BitWriter writer(bytes.data());
    const int low = std::min<int>(head.bits, low_bits), high = head.bits - low;
    for (const ExactSum& sum : sums) {
        const Wide q = magnitude(sum, head.unit);
        if (head.is_signed) writer.put(sum.high < 0, 1);
        writer.put(static_cast<std::uint64_t>(q) & ((std::uint64_t{1} << low) - 1), low);
        if (high > 0) writer.put(static_cast<std::uint64_t>(q >> low_bits), high);
    }
}

void put(const void* data, std::size_t size, std::string& bytes) {
    bytes.append(static_cast<const char*>(data), size);
}

/// The integers give the sums again.
bool gives(std::span<const ExactSum> sums, const GroupHead& head, const GroupBytes& bytes) {
    std::array<ExactSum, group_size> again{};
    add_some_integers(head, bytes.data(), {.first = again.data(), .count = sums.size()});
    return std::equal(
        sums.begin(), sums.end(), again.begin(),
        [](const ExactSum& a, const ExactSum& b) { return a.high == b.high && a.low == b.low; });
}

void pack_group(std::span<const ExactSum> sums, std::string& bytes) {
    if (const std::optional<GroupHead> head = common_head(sums)) {
        GroupBytes integers = {};
        put_integers(*head, sums, integers);
        if (gives(sums, *head, integers)) {
            put(&*head, sizeof *head, bytes);
            put(integers.data(), bytes_of_group(*head, sums.size()), bytes);
            return;
        }
    }
    const GroupHead head = {.bits = doubles};
    put(&head, sizeof head, bytes);
    put(sums.data(), sums.size_bytes(), bytes);
}

}  // namespace

void pack_sums(SumsOf<const ExactSum> sums, std::string& bytes) {
    for (std::size_t i = 0; i < sums.count; i += group_size) {
        const SumsOf<const ExactSum> group = sums.part(i, group_size);
        std::array<ExactSum, group_size> copy;
        for (std::size_t k = 0; k < group.count; ++k) copy[k] = group[k];
        pack_group(std::span(copy).first(group.count), bytes);
    }
}

bool PackedSums::add_to(SumsOf<ExactSum> sums) {
    for (std::size_t i = 0; i < sums.count; i += group_size) {
        if (!add_group(sums.part(i, group_size))) return false;
    }
    return true;
}

void add_sums(const ExactSum* terms, SumsOf<ExactSum> sums) {
    const std::size_t fours = sums.count & ~std::size_t{3};
    add_fours(terms, sums.part(0, fours));
    for (std::size_t i = fours; i < sums.count; ++i) sums[i].add(terms[i]);
}

std::optional<std::uint8_t> PackedSums::take_byte() {
    if (rest_.empty()) return {};
    const std::uint8_t byte = rest_.front();
    rest_ = rest_.subspan(1);
    return byte;
}

std::optional<PackedSums> PackedSums::take(std::size_t count) {
    const std::span<const std::uint8_t> all = rest_;
    for (std::size_t i = 0; i < count; i += group_size) {
        if (!take_group(rest_, std::min(group_size, count - i))) return {};
    }
    return PackedSums(all.first(all.size() - rest_.size()));
}

bool PackedSums::add_group(SumsOf<ExactSum> sums) {
    const std::optional<Group> group = take_group(rest_, sums.count);
    if (!group) return false;
    if (group->head.bits == doubles) {
        add_doubles(group->bytes.data(), sums);
    } else if (sums.count < group_size || rest_.size() < sizeof(std::uint64_t)) {
        GroupBytes copy = {};
        std::memcpy(copy.data(), group->bytes.data(), group->bytes.size());
        add_some_integers(group->head, copy.data(), sums);
    } else {
        add_some_integers(group->head, group->bytes.data(), sums);
    }
    return true;
}

}  // namespace lucerna
