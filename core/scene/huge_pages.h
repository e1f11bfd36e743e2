// SPDX-License-Identifier: Apache-2.0
/// Memory of large arrays that are read at random.
#pragma once

#include <sys/mman.h>

#include <cstddef>
#include <cstdlib>
#include <new>

namespace lucerna {

/// Allocates large arrays in pages of 2 MiB, if the system has them. Hits read triangles at random:
/// with small pages, most reads of a large mesh also miss the processor's table of addresses.
template <typename T>
struct HugePages {
    using value_type = T;
    HugePages() = default;
    template <typename U>
    HugePages(const HugePages<U>&) {}

    T* allocate(std::size_t count) {
        if (!is_large(count)) {
            return static_cast<T*>(
                ::operator new (count * sizeof(T), std::align_val_t{alignof(T)}));
        }
        const std::size_t bytes = (count * sizeof(T) + page - 1) / page * page;
        void* const memory = std::aligned_alloc(page, bytes);
        if (!memory) throw std::bad_alloc();
#if defined(MADV_HUGEPAGE)
        madvise(memory, bytes, MADV_HUGEPAGE);  // advice: that it can fail does not matter
#endif
        return static_cast<T*>(memory);
    }
    void deallocate(T* memory, std::size_t count) {
        if (is_large(count)) return std::free(memory);
        ::operator delete (memory, std::align_val_t{alignof(T)});
    }

    bool operator==(const HugePages&) const = default;

private:
    static constexpr std::size_t page = std::size_t{1} << 21;
    static bool is_large(std::size_t count) { return count >= 2 * page / sizeof(T); }
};

}  // namespace lucerna
