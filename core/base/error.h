// SPDX-License-Identifier: Apache-2.0
/// Errors with a place: what the author of a scene sees when something is wrong.
///
/// Plugins throw `Error` with a message only; the builder adds the place. Reading and building
/// collect everything that is wrong in one `Diagnostics`, so that all of it is reported at once.
#pragma once

#include <cstdint>
#include <stdexcept>
#include <string>
#include <string_view>
#include <vector>

namespace lucerna {

/// Something the user can mend. The message says what is wrong, what was expected, what to do.
class Error : public std::runtime_error {
public:
    using std::runtime_error::runtime_error;
    ~Error() override;
};

/// A plugin library that cannot be used: damaged, stale, or of another kind.
class PluginError : public Error {
public:
    using Error::Error;
    ~PluginError() override;
};

/// A file that cannot be read or written.
class FileError : public Error {
public:
    using Error::Error;
    ~FileError() override;
};

/// The same for a reason that may pass: a full disk, a network file system that has failed.
class TransientFileError : public FileError {
public:
    using FileError::FileError;
    ~TransientFileError() override;
};

/// The text of a scene file, kept so that messages can show the line they speak of.
struct SourceFile {
    std::string path;
    std::string text;
    /// Whether messages show lines of it. Not of an included file before it is known to be XML: it
    /// may be any file that the author of the scene could name but not read.
    bool is_shown = true;
};

/// A byte in a source file. Line and column are computed only when a message needs them.
struct Location {
    const SourceFile* file = nullptr;
    std::size_t offset = 0;
};

enum class Severity : std::uint8_t { error, warning };

/// One message, already detached from its source: `excerpt` is the source line and a caret.
struct Diagnostic {
    Severity severity = Severity::error;
    std::string file;
    int line = 0;    ///< 1-based; 0 if the message has no place
    int column = 0;  ///< 1-based
    std::string message;
    std::string excerpt;

    /// "scene.xml:13:9: error: message" followed by the excerpt, without a final newline.
    std::string text() const;

    bool operator==(const Diagnostic&) const = default;
};

/// All that is wrong with a scene, in the order in which it was found.
class Diagnostics {
public:
    void error(Location where, std::string_view message);
    void warning(Location where, std::string_view message);
    /// An error that is no fault of the scene: a library that cannot be used. Said once, however
    /// often the scene names it.
    void plugin_error(Location where, std::string_view message);

    const std::vector<Diagnostic>& all() const { return all_; }
    int error_count() const { return error_count_; }
    /// If there was an error, throws all that is known, each thing once and in the order of the
    /// files: SceneError, or PluginError if a library is among it.
    void throw_if_errors() const;

private:
    /// Lines of the message that are very long lose their middle.
    void add(Severity severity, Location where, std::string_view message);
    std::vector<Diagnostic> all_;
    int error_count_ = 0;
    bool plugin_failed_ = false;
};

/// A scene that cannot be rendered, with everything that is wrong with it.
class SceneError : public Error {
public:
    explicit SceneError(std::vector<Diagnostic> diagnostics);
    ~SceneError() override;
    const std::vector<Diagnostic>& diagnostics() const { return diagnostics_; }

private:
    std::vector<Diagnostic> diagnostics_;
};

/// The candidate nearest to `word` (Damerau-Levenshtein distance at most a third of its length,
/// at least 1), or empty.
std::string nearest(std::string_view word, const std::vector<std::string>& candidates);

/// `; did you mean "x"?` or empty: to be appended to a message.
std::string did_you_mean(std::string_view word, const std::vector<std::string>& candidates);

/// The text in quotation marks, shortened if it is long.
std::string quote(std::string_view text);

/// "a, b, c"
std::string join(const std::vector<std::string>& words, std::string_view separator = ", ");

}  // namespace lucerna
