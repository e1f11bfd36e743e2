// SPDX-License-Identifier: Apache-2.0
/// `lucerna render --preview` and `--json-progress`: what viewers, browsers and programs get, and
/// that none of them changes the render.
#include "tests/commands/render_command.h"
#include "tests/commands/tev_server.h"

#include <nlohmann/json.hpp>

#include <regex>

namespace lucerna {
namespace {

namespace fs = std::filesystem;
using std::chrono::milliseconds;
using std::chrono::seconds;
using Clock = std::chrono::steady_clock;
using Words = std::vector<std::string>;

class PreviewTest : public RenderCommandTest {
protected:
    /// R, G and B of a window of an image of the viewer, pixel by pixel.
    static std::vector<float> window(const Image& image, int x, int y, int width, int height) {
        std::vector<float> values;
        for (int v = y; v < y + height; ++v) {
            const float* const row = image.at(x, v);
            values.insert(values.end(), row, row + 3 * width);
        }
        return values;
    }
    std::vector<float> rgb_of_file(const char* file) const {
        const std::vector<float> r = plane(file, "R"), g = plane(file, "G"), b = plane(file, "B");
        std::vector<float> values;
        for (std::size_t i = 0; i < r.size(); ++i) values.insert(values.end(), {r[i], g[i], b[i]});
        return values;
    }
    std::size_t count(const std::string& words) const {
        std::size_t n = 0;
        for (std::size_t at = 0; (at = errors.find(words, at)) != std::string::npos; ++at) ++n;
        return n;
    }
};

TEST_F(PreviewTest, tev_ends_with_the_finished_picture_and_its_figures) {
    TevServer tev;
    render({"--resolution", "200x150", "--time", "2", "--preview", tev.place()});
    tev.stop();
    EXPECT_EQ(errors.find("warning"), std::string::npos) << errors;
    ASSERT_EQ(tev.created().size(), 2u);
    EXPECT_EQ(tev.created()[0], "scene.exr (rendering)");
    EXPECT_TRUE(std::regex_match(
        tev.created()[1], std::regex(R"(scene\.exr \(\d+ spp, \d+\.\d s(, relMSE [-0-9.e]+)?\))")))
        << tev.created()[1];
    // 2 × 2 tiles for each time.
    EXPECT_GE(tev.updates(), 8);
    EXPECT_EQ(tev.updates() % 4, 0);
    ASSERT_EQ(tev.images().size(), 1u);
    const Image& image = tev.images().at(tev.created()[1]);
    EXPECT_EQ(image.channels, (std::vector<std::string>{"R", "G", "B"}));
    EXPECT_EQ(window(image, 0, 0, 200, 150), rgb_of_file("scene.exr"));
}

TEST_F(PreviewTest, a_crop_is_where_it_belongs) {
    TevServer tev;
    render({"-q", "--crop", "5,7,10,8", "--preview", "tev:" + tev.place()});
    tev.stop();
    ASSERT_EQ(tev.images().size(), 1u);
    const Image& image = tev.images().begin()->second;
    EXPECT_EQ(image.width, 32);
    EXPECT_EQ(image.height, 24);
    EXPECT_EQ(window(image, 5, 7, 10, 8), rgb_of_file("scene.exr"));
    EXPECT_EQ(image.rgb(4, 7), Color(0));
    EXPECT_EQ(image.rgb(15, 14), Color(0));
}

TEST_F(PreviewTest, a_part_shows_itself) {
    const Words part = {"-q", "--spp", "8", "--part", "2/4"};
    const auto with = [&](Words more) {
        more.insert(more.end(), part.begin(), part.end());
        return more;
    };
    TevServer tev;
    render(with({"-o", "2.exr", "--preview", tev.place()}));
    tev.stop();
    ASSERT_EQ(tev.images().size(), 1u);
    EXPECT_TRUE(tev.created().back().starts_with("2.exr (2 spp, ")) << tev.created().back();
    const Image& image = tev.images().at(tev.created().back());
    // The picture of a state file has halves.
    const std::vector<float> seen = window(image, 0, 0, 32, 24), kept = rgb_of_file("2.exr");
    for (std::size_t i = 0; i < kept.size(); ++i) EXPECT_NEAR(seen[i], kept[i], 1e-3f * kept[i]);

    std::string lines = render(with({"-o", "3.exr", "--json-progress"}));
    lines.pop_back();
    const nlohmann::json last = nlohmann::json::parse(lines.substr(lines.rfind('\n') + 1));
    EXPECT_EQ(last.at("state"), "finished");
    EXPECT_EQ(last.at("file"), "3.exr");
    EXPECT_EQ(last.at("samples"), "2-3");
    EXPECT_EQ(plane("3.exr"), plane("2.exr"));
}

TEST_F(PreviewTest, no_viewer_changes_a_bit_or_the_exit_code) {
    const Words words = {"--spp", "128", "--resolution", "150x100"};
    const auto with = [&](Words more) {
        more.insert(more.end(), words.begin(), words.end());
        return more;
    };
    render(with({"-o", "alone"}));
    using Manner = TevServer::Manner;
    for (const Manner manner : {Manner::reads, Manner::never_reads, Manner::closes_each_time}) {
        TevServer tev(manner);
        render(with({"-o", "seen", "--preview", tev.place()}));
        EXPECT_EQ(plane("seen.exr"), plane("alone.exr"));
        EXPECT_GE(tev.connections(), 1);
    }
    render(with({"-o", "seen", "--preview", "web"}));
    EXPECT_EQ(plane("seen.exr"), plane("alone.exr"));
}

TEST_F(PreviewTest, an_absent_tev_is_told_once_and_is_found_later) {
    int port = 0;
    close(listening_socket(port));  // a port that is free
    const std::string place = "127.0.0.1:" + std::to_string(port);
    render({"-q", "--time", "1.5", "--preview", place});
    EXPECT_EQ(errors, "warning: there is no tev at " + place +
                          " (Connection refused); the render goes on, and shows itself once tev is "
                          "there\n");

    Process process(folder.path(),
                    {"render", "scene.xml", "-q", "--time", "9", "--preview", place});
    std::this_thread::sleep_for(milliseconds(500));
    TevServer tev(TevServer::Manner::reads, port);
    EXPECT_EQ(process.wait(), exit_code::success);
    tev.stop();
    EXPECT_EQ(tev.images().size(), 1u);
    EXPECT_GE(tev.updates(), 2);
}

TEST_F(PreviewTest, a_tev_that_takes_nothing_is_told_and_not_waited_for) {
    TevServer tev(TevServer::Manner::never_reads);
    const Clock::time_point start = Clock::now();
    // More than the system's buffers hold.
    render({"-q", "--resolution", "2000x1500", "--time", "1", "--preview", tev.place()});
    EXPECT_LT(Clock::now() - start, seconds(60));
    // It depends on the machine's speed whether tev hangs for five seconds before the render ends.
    const bool at_the_end =
        errors == "warning: the preview did not take the last picture in time\n";
    EXPECT_TRUE(at_the_end || errors == "warning: tev at " + tev.place() +
                                            " is gone (it takes no data); the render goes on, and "
                                            "shows itself once tev is back\n")
        << errors;
}

TEST_F(PreviewTest, a_tev_that_is_closed_is_told_once) {
    TevServer tev(TevServer::Manner::closes_each_time);
    render({"-q", "--time", "3", "--preview", tev.place()});
    EXPECT_EQ(count("warning"), 1u) << errors;
    expect_error("warning: tev at " + tev.place() + " is gone (");
}

TEST_F(PreviewTest, wrong_places_are_refused_exactly) {
    const auto refused = [&](const std::string& where, const std::string& message) {
        render({"--preview", where}, exit_code::usage);
        EXPECT_EQ(errors, "lucerna render: --preview " + where + ": " + message + "\n");
    };
    refused("tv",
            "there is no preview \"tv\"; did you mean \"tev\"?\n  there are: tev, web; "
            "HOST:PORT is a tev that listens there");
    refused("web:0", "\"0\" is no port; expected a number from 1 to 65535");
    refused("web:65536", "\"65536\" is no port; expected a number from 1 to 65535");
    refused("localhost:x", "\"x\" is no port; expected a number from 1 to 65535");
    refused("tev:[::1", "\"[::1\" is no address; expected HOST:PORT");
    refused("web:example.org:80",
            "\"example.org\" is no address of this machine; expected localhost or an address in "
            "numbers, such as 127.0.0.1");
    refused("web:0.0.0.0:8080", "0.0.0.0 means all addresses of this machine; give one of them");
    refused("web:192.0.2.1", "192.0.2.1 is no address of this machine");
    render({"--preview", "no-such-host.invalid:1"}, exit_code::usage);
    expect_error(
        "lucerna render: --preview no-such-host.invalid:1: the host \"no-such-host.invalid\" "
        "cannot be found: ");
    EXPECT_FALSE(fs::exists(folder / "scene.exr"));
}

TEST_F(PreviewTest, a_port_in_use_is_refused_exactly) {
    int port = 0;
    const int socket = listening_socket(port);
    const std::string number = std::to_string(port);
    render({"--preview", "web:" + number}, exit_code::usage);
    EXPECT_EQ(errors, "lucerna render: --preview web:" + number + ": port " + number +
                          " of 127.0.0.1 cannot be used: Address already in use; choose another, "
                          "or none for one that is free\n");
    close(socket);

    // Nor do two renders share one.
    const Words words = {"render", "scene.xml", "-q", "--time", "5", "--preview", "web:" + number};
    Process first(folder.path(), words);
    for (int i = 0; i < 500 && first.errors().find("preview: ") == std::string::npos; ++i) {
        std::this_thread::sleep_for(milliseconds(10));
    }
    TemporaryFolder other;
    std::ofstream(other / "scene.xml") << small_scene;
    Process second(other.path(), words);
    EXPECT_EQ(second.wait(), exit_code::usage);
    EXPECT_NE(second.errors().find("Address already in use"), std::string::npos);
}

TEST_F(PreviewTest, libraries_of_previews_are_opened_only_when_asked_for) {
    const auto maps = [](const Process& process) {
        return read_whole("/proc/" + std::to_string(process.id()) + "/maps");
    };
    const auto has = [](const std::string& text, const char* word) {
        return text.find(word) != std::string::npos;
    };
    const std::unique_ptr<Process> plain = start_endless();
    EXPECT_FALSE(has(maps(*plain), "/previews/"));
    EXPECT_FALSE(has(maps(*plain), "httplib"));
    fs::remove(folder / "state.exr");
    const std::unique_ptr<Process> seen = start_endless({"--preview", "web"});
    EXPECT_TRUE(has(maps(*seen), "/previews/web.so"));
    EXPECT_FALSE(has(maps(*seen), "/previews/tev.so"));
}

TEST_F(PreviewTest, programs_get_a_line_a_second_and_the_figures) {
    const std::string output =
        render({"--time", "2.5", "--json-progress", "--set", "integrator.reuse=1"});
    EXPECT_EQ(errors, "");
    std::istringstream lines(output);
    std::string line;
    std::vector<nlohmann::json> objects;
    while (std::getline(lines, line)) objects.push_back(nlohmann::json::parse(line));
    ASSERT_GE(objects.size(), 3u) << output;
    const nlohmann::json last = objects.back();
    objects.pop_back();
    double second = -1, fraction = -1;
    for (const nlohmann::json& object : objects) {
        EXPECT_EQ(object.at("schema"), 1);
        EXPECT_EQ(object.at("state"), "rendering");
        const nlohmann::json& progress = object.at("progress");
        EXPECT_GT(std::floor(progress.at("seconds").get<double>()), second) << output;
        EXPECT_GT(progress.at("fraction"), fraction);
        second = std::floor(progress.at("seconds").get<double>());
        fraction = progress.at("fraction");
    }
    EXPECT_EQ(last.at("state"), "finished");
    EXPECT_EQ(last.at("interrupted"), false);
    EXPECT_GT(last.at("figures").at("samples_per_pixel"), 0);
    render({"--json", "--json-progress"}, exit_code::usage);
    EXPECT_EQ(errors,
              "lucerna render: --json-progress ends with the figures that --json prints; give one "
              "of them\n");
}

/// A render with a page, and what asks it.
class WebPreviewTest : public PreviewTest {
protected:
    struct Answer {
        int status = 0;
        std::string head, body;
    };

    void start(Words words = {}, const std::string& place = "web") {
        const Words first = {"render", "scene.xml", "-q", "--resolution",
                             "60x40",  "--preview", place};
        words.insert(words.begin(), first.begin(), first.end());
        process_ = std::make_unique<Process>(folder.path(), words);
        std::smatch found;
        const std::regex address("preview: http://127\\.0\\.0\\.1:(\\d+)(/[0-9a-f]{32}/)\n");
        for (int i = 0; i < 500; ++i) {
            text_ = process_->errors();
            if (std::regex_search(text_, found, address)) break;
            std::this_thread::sleep_for(milliseconds(10));
        }
        ASSERT_FALSE(found.empty()) << text_;
        port_ = std::stoi(found[1]);
        root_ = found[2];
        host_ = "127.0.0.1:" + std::to_string(port_);
    }
    /// `headers`: lines beside the one of Host, each with its end.
    Answer ask(const std::string& method, const std::string& path, const std::string& headers = "",
               const std::string& host = "") const {
        const int socket = ::socket(AF_INET, SOCK_STREAM, 0);
        sockaddr_in address{};
        address.sin_family = AF_INET;
        address.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
        address.sin_port = htons(static_cast<std::uint16_t>(port_));
        EXPECT_EQ(connect(socket, reinterpret_cast<sockaddr*>(&address), sizeof address), 0);
        const std::string request =
            method + " " + path + " HTTP/1.1\r\nHost: " + (host.empty() ? host_ : host) + "\r\n" +
            headers + (method == "POST" ? "Content-Length: 0\r\n\r\n" : "\r\n");
        EXPECT_EQ(send(socket, request.data(), request.size(), 0), ssize_t(request.size()));
        std::string text, bytes(1 << 16, '\0');
        for (ssize_t n; (n = recv(socket, bytes.data(), bytes.size(), 0)) > 0;) {
            text.append(bytes, 0, static_cast<std::size_t>(n));
        }
        close(socket);
        const std::size_t end = std::min(text.find("\r\n\r\n"), text.size());
        return {text.size() > 12 ? std::stoi(text.substr(9, 3)) : 0, text.substr(0, end),
                text.substr(std::min(end + 4, text.size()))};
    }
    nlohmann::json status() const {
        return nlohmann::json::parse(ask("GET", root_ + "status").body);
    }
    /// Asks until the render says so.
    nlohmann::json wait_for(const std::function<bool(const nlohmann::json&)>& condition) const {
        nlohmann::json now;
        for (int i = 0; i < 300; ++i) {
            now = status();
            if (condition(now)) return now;
            std::this_thread::sleep_for(milliseconds(50));
        }
        ADD_FAILURE() << now;
        return now;
    }
    std::string own_origin() const { return "Origin: http://" + host_ + "\r\n"; }

    std::unique_ptr<Process> process_;
    std::string text_, root_, host_;
    int port_ = 0;
};

TEST_F(WebPreviewTest, shows_the_render_to_its_last_figures) {
    start({"--time", "4", "--exposure", "1.5"});
    const Answer page = ask("GET", root_);
    EXPECT_EQ(page.status, 200);
    EXPECT_NE(page.body.find("<canvas id=\"picture\""), std::string::npos);
    EXPECT_EQ(page.body.find("@nonce@"), std::string::npos);
    for (const char* header : {"Cache-Control: no-store", "frame-ancestors 'none'",
                               "Referrer-Policy: no-referrer", "X-Frame-Options: DENY"}) {
        EXPECT_NE(page.head.find(header), std::string::npos) << header;
    }
    const nlohmann::json early =
        wait_for([](const nlohmann::json& now) { return now.at("picture") > 0; });
    EXPECT_EQ(early.at("state"), "rendering");
    EXPECT_EQ(early.at("exposure"), 1.5);
    EXPECT_GT(early.at("progress").at("seconds_left"), 0);
    EXPECT_EQ(ask("GET", root_ + "picture").body.size(), 8u + 60 * 40 * 12);

    const nlohmann::json last =
        wait_for([](const nlohmann::json& now) { return now.at("state") == "finished"; });
    EXPECT_GE(last.at("errors").size(), 2u);
    EXPECT_NE(last.at("figures_text").get<std::string>().find(" spp; "), std::string::npos);
    const std::string bytes = ask("GET", root_ + "picture").body;
    EXPECT_EQ(process_->wait(), exit_code::success);
    const std::vector<float> expected = rgb_of_file("scene.exr");
    ASSERT_EQ(bytes.size(), 8 + 4 * expected.size());
    EXPECT_EQ(std::memcmp(bytes.data() + 8, expected.data(), 4 * expected.size()), 0);
}

TEST_F(WebPreviewTest, the_button_ends_the_render_as_a_signal_does) {
    start({"--spp", "100000000"});
    wait_for([](const nlohmann::json& now) {
        return now.at("state") == "rendering" && now.at("progress").at("samples_per_pixel") > 0;
    });
    EXPECT_EQ(ask("POST", root_ + "stop", own_origin()).status, 204);
    EXPECT_EQ(process_->wait(), exit_code::interrupted);
    EXPECT_EQ(plane("scene.exr").size(), 60u * 40u);
}

TEST_F(WebPreviewTest, nobody_else_can_press_the_button) {
    start({"--spp", "100000000"});
    wait_for([](const nlohmann::json& now) { return now.at("state") == "rendering"; });
    const std::string stop = root_ + "stop", number = std::to_string(port_);
    // Another site in the same browser, a page without an origin, a form, none at all.
    for (const std::string origin :
         {"http://example.org", "null", "https://127.0.0.1", "http://127.0.0.1", ""}) {
        const std::string header = origin.empty() ? "" : "Origin: " + origin + "\r\n";
        EXPECT_EQ(ask("POST", stop, header).status, 403) << origin;
    }
    // A name of another site that leads to this machine.
    EXPECT_EQ(
        ask("POST", stop, "Origin: http://example.org:" + number + "\r\n", "example.org:" + number)
            .status,
        403);
    EXPECT_EQ(ask("GET", root_ + "status", "", "example.org:" + number).status, 403);
    // Another server of this machine.
    EXPECT_EQ(ask("POST", stop, "Origin: http://localhost:1\r\n").status, 403);
    // Whoever does not know the token; links and pictures.
    EXPECT_EQ(ask("GET", "/").status, 404);
    std::string wrong = root_;
    wrong[7] = wrong[7] == '0' ? '1' : '0';
    EXPECT_EQ(ask("GET", wrong + "status").status, 404);
    EXPECT_EQ(ask("POST", wrong + "stop", own_origin()).status, 404);
    EXPECT_EQ(ask("POST", root_.substr(0, 30) + "/stop", own_origin()).status, 404);
    EXPECT_EQ(ask("GET", stop, own_origin()).status, 404);
    EXPECT_EQ(status().at("state"), "rendering");
}

TEST_F(WebPreviewTest, a_page_that_is_closed_is_not_waited_for) {
    start({"--time", "5"});
    wait_for([](const nlohmann::json& now) { return now.at("picture") > 0; });
    const Clock::time_point left = Clock::now();
    EXPECT_EQ(process_->wait(), exit_code::success);
    EXPECT_LT(Clock::now() - left, seconds(20));
    EXPECT_EQ(process_->errors().find("warning"), std::string::npos) << process_->errors();
}

}  // namespace
}  // namespace lucerna
