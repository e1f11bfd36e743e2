// SPDX-License-Identifier: Apache-2.0
/// Reads a grid of floats from an OpenVDB file. With openvdb.cpp, the only user of OpenVDB.
///
/// The library's own class for files takes what a truncated file lacks as zeros, and may read on for
/// hours in a damaged one. Here its parts read from a stream that throws at the end of the file.
#pragma once

#include "core/base/error.h"

#include <fmt/format.h>
#include <openvdb/openvdb.h>

#include <sstream>
#include <string>

namespace lucerna {

class VdbReader final : private openvdb::io::Archive {
public:
    /// `name` begins the messages.
    VdbReader(std::string bytes, std::string name)
        : stream_(std::move(bytes), std::ios::in | std::ios::binary), name_(std::move(name)) {
        openvdb::initialize();
        stream_.exceptions(std::ios::failbit | std::ios::badbit | std::ios::eofbit);
    }

    /// Throws Error for what is no such file, is damaged or truncated, or has no such grid of
    /// floats. The numbers of the grid may be anything.
    openvdb::FloatGrid::Ptr read(const std::string& grid_name) {
        using namespace openvdb;
        if (stream_.view().starts_with("NanoVDB")) {
            fail("this is a NanoVDB file; convert it to OpenVDB with nanovdb_convert");
        }
        try {
            return find(grid_name);
        } catch (const Error&) {
            throw;
        } catch (const std::ios_base::failure&) {
            fail("the file ends too early, or is damaged");
        } catch (const std::bad_alloc&) {
            fail("the file is damaged, or does not fit into memory");
        } catch (const std::exception& error) {
            fail(fmt::format("OpenVDB cannot read it: {}", error.what()));
        }
    }

private:
    void read_beginning() {
        try {
            readHeader(stream_);
        } catch (const openvdb::IoError&) {
            fail("this is not an OpenVDB file, or of a version that the library does not read");
        }
        openvdb::io::StreamMetadata::Ptr metadata(new openvdb::io::StreamMetadata);
        metadata->setSeekable(true);
        openvdb::io::setStreamMetadataPtr(stream_, metadata);
        setFormatVersion(stream_);
        setLibraryVersion(stream_);
        setDataCompression(stream_);
        openvdb::MetaMap().readMeta(stream_);
    }

    openvdb::FloatGrid::Ptr find(const std::string& grid_name) {
        read_beginning();
        std::vector<std::string> names;
        for (std::int32_t left = readGridCount(stream_); left > 0; --left) {
            openvdb::io::GridDescriptor descriptor;
            const openvdb::GridBase::Ptr grid = descriptor.read(stream_);
            if (descriptor.gridName() == grid_name) return complete(grid, descriptor);
            names.push_back(descriptor.gridName());
            if (inputHasGridOffsets()) {
                // A grid that ends where it begins, or before, would be read for ever.
                if (descriptor.getEndPos() <= stream_.tellg()) fail("its table is damaged");
                descriptor.seekToEnd(stream_);
            } else {
                readGrid(grid, descriptor, stream_);
            }
        }
        fail(fmt::format("there is no grid \"{}\"{}\n  there are: {}", grid_name,
                         did_you_mean(grid_name, names), join(names)));
    }

    openvdb::FloatGrid::Ptr complete(const openvdb::GridBase::Ptr& grid,
                                     const openvdb::io::GridDescriptor& descriptor) {
        const std::string& name = descriptor.gridName();
        const auto floats = openvdb::gridPtrCast<openvdb::FloatGrid>(grid);
        if (!floats) {
            fail(fmt::format("grid \"{}\" is a {}; only {} is read", name, descriptor.gridType(),
                             openvdb::FloatGrid::gridType()));
        }
        if (descriptor.isInstance()) {
            fail(fmt::format(
                "grid \"{}\" shows the voxels of \"{}\", which is not supported: name "
                "that one",
                name, openvdb::io::GridDescriptor::nameAsString(descriptor.instanceParentName())));
        }
        readGrid(grid, descriptor, stream_);
        return floats;
    }

    [[noreturn]] void fail(const std::string& message) const {
        throw Error(fmt::format("{}: {}", name_, message));
    }

    std::istringstream stream_;
    std::string name_;
};

}  // namespace lucerna
