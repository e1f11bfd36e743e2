// SPDX-License-Identifier: Apache-2.0
/// Memory of large arrays that are read at random.
#pragma once

#include <cstddef>
#include <new>

namespace lucerna {

inline constexpr std::size_t huge_page = std::size_t{1} << 21;

/// `bytes`, a multiple of huge_page. Throws std::bad_alloc.
void* allocate_huge_pages(std::size_t bytes);
void free_huge_pages(void* memory);

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
        const std::size_t pages = (count * sizeof(T) + huge_page - 1) / huge_page;
        return static_cast<T*>(allocate_huge_pages(pages * huge_page));
    }
    void deallocate(T* memory, std::size_t count) {
        if (is_large(count)) return free_huge_pages(memory);
        ::operator delete (memory, std::align_val_t{alignof(T)});
    }

    bool operator==(const HugePages&) const = default;

private:
    static bool is_large(std::size_t count) { return count >= 2 * huge_page / sizeof(T); }
};

}  // namespace lucerna
