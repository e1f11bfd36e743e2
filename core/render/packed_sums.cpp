// SPDX-License-Identifier: Apache-2.0
#include "core/render/packed_sums.h"

#include "core/interfaces/batch/lanes.h"

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

/// Little-endian bits, at most 57 at once.
class BitWriter {
public:
    explicit BitWriter(std::string& bytes) : bytes_(bytes) {}
    ~BitWriter() {
        while (count_ > 0) put_byte();
    }
    BitWriter(const BitWriter&) = delete;
    BitWriter& operator=(const BitWriter&) = delete;
    void put(std::uint64_t bits, int count) {
        waiting_ |= bits << count_;
        count_ += count;
        while (count_ >= 8) put_byte();
    }

private:
    void put_byte() {
        bytes_ += static_cast<char>(waiting_ & 0xff);
        waiting_ >>= 8;
        count_ -= 8;
    }
    std::string& bytes_;
    std::uint64_t waiting_ = 0;
    int count_ = 0;
};

std::size_t bytes_of_group(const GroupHead& head, std::size_t count) {
    if (head.bits == doubles) return count * sizeof(ExactSum);
    return (count * (std::size_t{head.bits} + head.is_signed) + 7) / 8;
}

/// Sums of a group, in arrays of their own: compilers make vector instructions of loops over them.
struct alignas(64) GroupSums {
    std::array<double, group_size> high, low;
};

/// The bits `position` and up of some bytes, 57 at least; reads 8 bytes.
std::uint64_t bits_at(const std::uint8_t* bytes, std::size_t position) {
    std::uint64_t word = 0;
    std::memcpy(&word, bytes + (position >> 3), sizeof word);
    return word >> (position & 7);
}

/// An integer below 2⁵² as a double, without the conversion that most processors have for single
/// numbers only.
double as_double(std::uint64_t integer) {
    constexpr std::uint64_t two_to_52 = 0x4330000000000000u;
    return std::bit_cast<double>(integer | two_to_52) - std::bit_cast<double>(two_to_52);
}

/// The sums whose integers lie at `bytes`; reads up to 8 bytes beyond them.
LUCERNA_VECTORIZED void unpack(const GroupHead& head, const std::uint8_t* bytes, std::size_t count,
                               GroupSums& sums) {
    const int low = std::min<int>(head.bits, low_bits), high = head.bits - low;
    const int sign = head.is_signed;
    const std::size_t width = std::size_t{head.bits} + head.is_signed;
    const std::uint64_t low_mask = (std::uint64_t{1} << low) - 1;
    const std::uint64_t high_mask = (std::uint64_t{1} << high) - 1;
    const double low_unit = std::ldexp(1.0, head.unit);
    const double high_unit = std::ldexp(1.0, head.unit + low_bits);
    std::array<std::uint64_t, group_size> first, second;
    for (std::size_t i = 0; i < count; ++i) {
        first[i] = bits_at(bytes, i * width);
        second[i] = bits_at(bytes, i * width + static_cast<std::size_t>(sign + low));
    }
    for (std::size_t i = 0; i < count; ++i) {
        const std::uint64_t negative = head.is_signed ? first[i] << 63 : 0;
        const std::uint64_t upper = second[i] & high_mask;
        // The upper part can have 53 bits.
        const double large = as_double(upper >> 1) * 2 + as_double(upper & 1);
        const double a = large * high_unit, b = as_double(first[i] >> sign & low_mask) * low_unit;
        const double sum = a + b, rest = b - (sum - a);
        sums.high[i] = std::bit_cast<double>(std::bit_cast<std::uint64_t>(sum) ^ negative);
        sums.low[i] = std::bit_cast<double>(std::bit_cast<std::uint64_t>(rest) ^ negative);
    }
}

/// Adds `terms` to `sums`.
LUCERNA_VECTORIZED void add(const GroupSums& terms, std::size_t count, GroupSums& sums) {
    for (std::size_t i = 0; i < count; ++i) {
        ExactSum sum = {.high = sums.high[i], .low = sums.low[i]};
        sum.add({.high = terms.high[i], .low = terms.low[i]});
        sums.high[i] = sum.high;
        sums.low[i] = sum.low;
    }
}

/// Adds the integers that lie at `bytes` to the sums.
void add_integers(const GroupHead& head, const std::uint8_t* bytes, SumsOf<ExactSum> sums) {
    GroupSums terms, all;
    unpack(head, bytes, sums.count, terms);
    for (std::size_t i = 0; i < sums.count; ++i) {
        all.high[i] = sums[i].high;
        all.low[i] = sums[i].low;
    }
    add(terms, sums.count, all);
    for (std::size_t i = 0; i < sums.count; ++i) sums[i] = {all.high[i], all.low[i]};
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

void put_integers(const GroupHead& head, std::span<const ExactSum> sums, std::string& bytes) {
    BitWriter writer(bytes);
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

/// What was put at `begin` gives the sums again.
bool gives(std::span<const ExactSum> sums, const GroupHead& head, const std::string& bytes,
           std::size_t begin) {
    GroupBytes copy = {};
    std::memcpy(copy.data(), bytes.data() + begin, bytes.size() - begin);
    std::array<ExactSum, group_size> again;
    again.fill({});
    add_integers(head, copy.data(), {.first = again.data(), .count = sums.size()});
    return std::equal(
        sums.begin(), sums.end(), again.begin(),
        [](const ExactSum& a, const ExactSum& b) { return a.high == b.high && a.low == b.low; });
}

void pack_group(std::span<const ExactSum> sums, std::string& bytes) {
    const std::size_t begin = bytes.size();
    if (const std::optional<GroupHead> head = common_head(sums)) {
        put(&*head, sizeof *head, bytes);
        put_integers(*head, sums, bytes);
        if (gives(sums, *head, bytes, begin + sizeof *head)) return;
        bytes.resize(begin);
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
    } else if (rest_.size() < sizeof(std::uint64_t)) {
        GroupBytes copy = {};
        std::memcpy(copy.data(), group->bytes.data(), group->bytes.size());
        add_integers(group->head, copy.data(), sums);
    } else {
        add_integers(group->head, group->bytes.data(), sums);
    }
    return true;
}

}  // namespace lucerna
