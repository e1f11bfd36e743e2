// SPDX-License-Identifier: Apache-2.0
#include "core/command_line/program.h"

#include "core/interfaces/command.h"
#include "core/plugin/registry.h"
#include "core/scene/builder.h"

#include <cstdio>
#include <cstdlib>
#include <exception>
#include <new>

namespace lucerna {

namespace {

std::string usage(Registry& registry) {
    std::string text =
        "usage: lucerna [--plugins DIR]... COMMAND [ARGUMENT]...\n\n"
        "A physically based renderer made of plugins.\n\ncommands:\n";
    for (const std::string& name : registry.names(Command::kind)) {
        std::string summary;
        try {
            summary = registry.find(Command::kind, name).summary;
        } catch (const Error& e) {
            summary = std::string("cannot be loaded: ") + e.what();
        }
        std::string column = "  " + name;
        column.resize(std::max<std::size_t>(column.size() + 2, 16), ' ');
        text += column + summary + "\n";
    }
    text +=
        "\noptions:\n"
        "  --plugins DIR  look for plugins in DIR first ($LUCERNA_PLUGINS: a list of folders)\n"
        "  --version      print the version\n"
        "  --help         print this; `lucerna COMMAND --help` tells of a command\n";
    return text;
}

/// Puts a folder in front of $LUCERNA_PLUGINS, where every registry looks.
void add_plugin_folder(const std::string& folder) {
    const char* before = std::getenv("LUCERNA_PLUGINS");
    const std::string list = before && *before ? folder + ":" + before : folder;
    setenv("LUCERNA_PLUGINS", list.c_str(), 1);
}

int run(std::vector<std::string>& arguments) {
    while (arguments.size() >= 2 && arguments[0] == "--plugins") {
        add_plugin_folder(arguments[1]);
        arguments.erase(arguments.begin(), arguments.begin() + 2);
    }
    Registry registry;
    if (arguments.empty() || arguments[0] == "--help" || arguments[0] == "-h") {
        std::fputs(usage(registry).c_str(), arguments.empty() ? stderr : stdout);
        return arguments.empty() ? exit_code::usage : exit_code::success;
    }
    if (arguments[0] == "--version") {
        std::printf("lucerna %s\n%s\n", core_version(), core_built_with());
        return exit_code::success;
    }
    const std::string verb = arguments[0];
    if (registry.path(Command::kind, verb).empty()) {
        const std::vector<std::string> commands = registry.names(Command::kind);
        std::fprintf(stderr, "lucerna: there is no command \"%s\"%s\n  there are: %s\n",
                     verb.c_str(), did_you_mean(verb, commands).c_str(), join(commands).c_str());
        return exit_code::usage;
    }
    const std::unique_ptr<Object> command = make_object(registry, Command::kind, verb);
    arguments.erase(arguments.begin());
    return static_cast<const Command&>(*command).run(arguments);
}

int report(const char* message, int code) {
    std::fflush(stdout);
    std::fprintf(stderr, "%s\n", message);
    return code;
}

}  // namespace

int run_program(std::vector<std::string> arguments) {
    try {
        return run(arguments);
    } catch (const SceneError& e) {
        return report(e.what(), exit_code::scene);
    } catch (const PluginError& e) {
        return report(e.what(), exit_code::plugin);
    } catch (const FileError& e) {
        return report(e.what(), exit_code::file);
    } catch (const std::bad_alloc&) {
        return report("lucerna: out of memory", exit_code::failure);
    } catch (const std::exception& e) {
        return report(e.what(), exit_code::failure);
    }
}

}  // namespace lucerna
