// SPDX-License-Identifier: Apache-2.0
/// web: a page that shows the render and can stop it. The only user of cpp-httplib.
///
/// Who may see the page: programs on this machine, unless another address is given, that know the
/// random token in its path. No other site can use the page of a browser: requests must name this
/// server as their host (against DNS rebinding), what stops the render must come from this page
/// (Origin), and no page may embed this one.
#include "core/base/json.h"
#include "core/interfaces/preview.h"
#include "core/render/progress.h"
#include "core/render/statistics.h"
#include "plugins/previews/error_history.h"
#include "plugins/previews/place.h"
#include "plugins/previews/reduced_image.h"

#include <httplib.h>

#include <arpa/inet.h>
#include <sys/random.h>

#include <atomic>
#include <condition_variable>
#include <cstdio>
#include <mutex>
#include <thread>

namespace lucerna {

extern const unsigned char preview_page[];
extern const std::size_t preview_page_size;

namespace {

using namespace std::chrono_literals;
using Clock = std::chrono::steady_clock;

/// The page asks twice a second.
constexpr std::chrono::milliseconds longest_silence = 2500ms;
constexpr std::size_t threads_of_server = 4;
/// Larger pictures are shown reduced. [pixels]
constexpr int largest_side = 2048;

/// 128 bits from the system's generator, in hexadecimal.
std::string random_token() {
    unsigned char bytes[16];
    if (getrandom(bytes, sizeof bytes, 0) != sizeof bytes) throw Error("no random numbers");
    std::string token;
    for (const unsigned char byte : bytes) token += fmt::format("{:02x}", byte);
    return token;
}

/// Takes the same time wherever two texts of equal length differ.
bool same_secret(std::string_view a, std::string_view b) {
    if (a.size() != b.size()) return false;
    int difference = 0;
    for (std::size_t i = 0; i < a.size(); ++i) difference |= a[i] ^ b[i];
    return difference == 0;
}

bool is_loopback(const std::string& host) {
    in_addr address{};
    const bool ipv4 = inet_pton(AF_INET, host.c_str(), &address) == 1;
    return host == "localhost" || host == "::1" || (ipv4 && ntohl(address.s_addr) >> 24 == 127);
}

/// Requests must name one address, so that there must be one.
void check_address(const std::string& host) {
    in6_addr address{};
    const bool numeric = inet_pton(AF_INET, host.c_str(), &address) == 1 ||
                         inet_pton(AF_INET6, host.c_str(), &address) == 1;
    if (host == "localhost") return;
    if (!numeric) {
        throw Error(
            fmt::format("{} is no address of this machine; expected localhost or an "
                        "address in numbers, such as 127.0.0.1",
                        quote(host)));
    }
    if (host == "0.0.0.0" || host == "::") {
        throw Error(fmt::format("{} means all addresses of this machine; give one of them", host));
    }
}

class WebPreview final : public Preview {
public:
    explicit WebPreview(const Params&) {}
    ~WebPreview() override;

    void open(const std::string& place, const PreviewSubject& subject) override;
    bool watched() const override {
        return Clock::now().time_since_epoch() - last_request_.load() < longest_silence;
    }
    void show_status(const RenderStatus& status) override;
    void show_picture(const PreviewPicture& picture) override;
    void finish(const PreviewPicture& picture, const RenderFigures& figures) override;
    void cancel() override;

private:
    using Request = httplib::Request;
    using Response = httplib::Response;
    void bind();
    void serve();
    /// Refuses what the page of this render would not ask, with 403 or 404.
    bool refuse(const Request& request, Response& response) const;
    void answer_status(Response& response);
    void answer_picture(Response& response);
    void answer_stop(const Request& request, Response& response);
    void set_picture(std::string bytes);
    std::string origin() const { return "http://" + place_.text(); }

    Place place_;
    PreviewSubject subject_;
    std::string token_, nonce_;
    httplib::Server server_;
    std::thread thread_;
    std::atomic<Clock::duration> last_request_{Clock::duration{}};

    std::mutex mutex_;
    std::condition_variable changed_;
    std::optional<RenderStatus> status_;
    std::optional<RenderFigures> figures_;  ///< when the render has ended
    ErrorHistory history_;
    std::string picture_;  ///< width and height as uint32, then R, G, B as floats
    int picture_number_ = 0;
    bool figures_seen_ = false, last_picture_seen_ = false, cancelled_ = false;
};

WebPreview::~WebPreview() {
    cancel();
    if (!thread_.joinable()) return;
    server_.stop();
    thread_.join();
}

void WebPreview::open(const std::string& place, const PreviewSubject& subject) {
    place_ = parse_place(place, {"127.0.0.1", 0});
    check_address(place_.host);
    subject_ = subject;
    token_ = random_token();
    nonce_ = random_token();
    bind();
    serve();
    if (!is_loopback(place_.host)) {
        fmt::print(stderr,
                   "warning: who knows the address of the preview can see the picture and stop the "
                   "render from other machines, and nothing is encrypted\n");
    }
    fmt::print(stderr, "preview: {}/{}/\n", origin(), token_);
}

void WebPreview::bind() {
    // The library's own choice, SO_REUSEPORT, would let two renders share a port.
    server_.set_socket_options([](auto socket) {
        const int yes = 1;
        setsockopt(socket, SOL_SOCKET, SO_REUSEADDR, &yes, sizeof yes);
    });
    if (place_.port == 0) {
        place_.port = server_.bind_to_any_port(place_.host.c_str());
        if (place_.port > 0) return;
        throw Error(fmt::format("{} is no address of this machine", place_.host));
    }
    if (server_.bind_to_port(place_.host.c_str(), place_.port)) return;
    throw Error(
        fmt::format("port {} of {} cannot be used: {}; choose another, or none for one that "
                    "is free",
                    place_.port, place_.host, std::strerror(errno)));
}

void WebPreview::serve() {
    server_.new_task_queue = [] { return new httplib::ThreadPool(threads_of_server); };
    server_.set_keep_alive_max_count(1);  // else idle connections would hold the threads
    server_.set_read_timeout(2s);
    server_.set_write_timeout(5s);
    server_.set_payload_max_length(0);
    server_.set_default_headers(
        {{"Cache-Control", "no-store"},
         {"Content-Security-Policy",
          fmt::format("default-src 'none'; script-src 'nonce-{0}'; style-src 'nonce-{0}'; "
                      "img-src data:; connect-src 'self'; base-uri 'none'; form-action 'none'; "
                      "frame-ancestors 'none'",
                      nonce_)},
         {"Cross-Origin-Resource-Policy", "same-origin"},
         {"Referrer-Policy", "no-referrer"},
         {"X-Content-Type-Options", "nosniff"},
         {"X-Frame-Options", "DENY"}});
    server_.set_pre_routing_handler([this](const Request& request, Response& response) {
        using Result = httplib::Server::HandlerResponse;
        return refuse(request, response) ? Result::Handled : Result::Unhandled;
    });
    const std::string root = "/" + token_ + "/";
    server_.Get(root, [this](const Request&, Response& response) {
        std::string page(reinterpret_cast<const char*>(preview_page), preview_page_size);
        for (std::size_t at; (at = page.find("@nonce@")) != std::string::npos;) {
            page.replace(at, 7, nonce_);
        }
        response.set_content(page, "text/html; charset=utf-8");
    });
    server_.Get(root + "status", [this](const Request&, Response& r) { answer_status(r); });
    server_.Get(root + "picture", [this](const Request&, Response& r) { answer_picture(r); });
    server_.Post(root + "stop", [this](const Request& q, Response& r) { answer_stop(q, r); });
    thread_ = std::thread([this] { server_.listen_after_bind(); });
    // stop() does nothing before that.
    while (!server_.is_running()) std::this_thread::sleep_for(1ms);
}

bool WebPreview::refuse(const Request& request, Response& response) const {
    const std::string host = request.get_header_value("Host");
    const bool ours = host == place_.text() ||
                      (is_loopback(place_.host) && host == Place{"localhost", place_.port}.text());
    if (!ours) {
        response.status = 403;
        return true;
    }
    const std::string_view path = request.path;
    const bool known = path.size() > token_.size() + 1 && path[token_.size() + 1] == '/' &&
                       same_secret(path.substr(1, token_.size()), token_);
    if (!known) response.status = 404;
    return !known;
}

void WebPreview::answer_status(Response& response) {
    last_request_ = Clock::now().time_since_epoch();
    const std::lock_guard lock(mutex_);
    Json json = Json::object();
    json.set("schema", 1).set("name", subject_.name).set("exposure", subject_.exposure);
    json.set("state", figures_ ? "finished" : status_ ? "rendering" : "loading");
    json.set("progress", status_ ? to_json(*status_) : Json());
    json.set("errors", history_.json()).set("picture", picture_number_);
    json.set("figures", figures_ ? to_json(*figures_) : Json());
    json.set("figures_text", figures_ ? figures_text(*figures_) : std::string());
    response.set_content(json.line(), "application/json");
    figures_seen_ = figures_.has_value();
    changed_.notify_all();
}

void WebPreview::answer_picture(Response& response) {
    const std::lock_guard lock(mutex_);
    response.set_content(picture_, "application/octet-stream");
    last_picture_seen_ = figures_seen_;
    changed_.notify_all();
}

void WebPreview::answer_stop(const Request& request, Response& response) {
    const std::string from = request.get_header_value("Origin");
    if (from != "http://" + request.get_header_value("Host")) {
        response.status = 403;
        return;
    }
    const std::lock_guard lock(mutex_);
    response.status = status_ && !figures_ ? 204 : 409;
    if (response.status == 204) subject_.stop();
}

void WebPreview::show_status(const RenderStatus& status) {
    const std::lock_guard lock(mutex_);
    status_ = status;
    history_.add(status);
}

void WebPreview::show_picture(const PreviewPicture& picture) {
    std::string bytes = reduced_picture_bytes(picture.image, largest_side);
    const std::lock_guard lock(mutex_);
    set_picture(std::move(bytes));
}

void WebPreview::finish(const PreviewPicture& picture, const RenderFigures& figures) {
    std::string bytes = reduced_picture_bytes(picture.image, largest_side);
    std::unique_lock lock(mutex_);
    set_picture(std::move(bytes));
    figures_ = figures;
    changed_.wait(lock, [&] { return cancelled_ || last_picture_seen_; });
}

void WebPreview::cancel() {
    const std::lock_guard lock(mutex_);
    cancelled_ = true;
    changed_.notify_all();
}

void WebPreview::set_picture(std::string bytes) {
    picture_ = std::move(bytes);
    ++picture_number_;
}

}  // namespace

const PluginInfo plugin = describe<WebPreview>("shows the running render on a page for browsers");

}  // namespace lucerna
