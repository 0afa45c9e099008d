#include "pilotage/airsim/rpc_client.h"

#include <utility>

#include "pilotage/base/error.h"
#include "pilotage/base/text.h"

namespace pilotage {
namespace {

constexpr std::size_t kReceiveBytes = std::size_t{256} << 10;

Deadline deadline_after(double seconds) {
  return std::chrono::steady_clock::now() +
         std::chrono::duration_cast<std::chrono::steady_clock::duration>(std::chrono::duration<double>(seconds));
}

/// What a server's error says, cut where it is long.
std::string error_text(const RpcValue& error) {
  const auto* text = std::get_if<std::string>(&error.data);
  if (text == nullptr) return rpc_kind(error);
  constexpr std::size_t kMost = 500;
  return text->size() <= kMost ? *text : text->substr(0, kMost) + " …";
}

std::optional<std::uint32_t> call_number(const RpcValue& value) {
  const auto* number = std::get_if<std::uint64_t>(&value.data);
  if (number == nullptr || *number > 0xFFFFFFFFU) return std::nullopt;
  return static_cast<std::uint32_t>(*number);
}

}  // namespace

RpcClient::RpcClient(const HostPort& peer, double timeout_s, const RpcLimits& limits, std::function<bool()> go_on)
    : peer_(peer),
      timeout_s_(timeout_s),
      limits_(limits),
      go_on_(std::move(go_on)),
      stream_(connect_to(peer, {deadline_after(timeout_s), go_on_})),
      scanner_(limits) {}

std::string RpcClient::where(const std::string& method) const {
  return peer_.text() + ": " + method + ": ";
}

void RpcClient::fail(const std::string& method, const std::string& problem) {
  stream_ = Descriptor();
  throw DataError(where(method) + problem);
}

std::uint32_t RpcClient::send(const std::string& method, RpcArray arguments) {
  if (!stream_.is_open()) throw DataError(where(method) + "the connection was closed after an earlier error");
  const std::uint32_t number = next_call_++;
  const RpcValue request = RpcArray{std::uint64_t{0}, std::uint64_t{number}, method, RpcValue(std::move(arguments))};
  const Transfer sent = send_all(stream_, encode_rpc(request), {deadline_after(timeout_s_), go_on_});
  if (sent == Transfer::kClosed) fail(method, "the server has closed the connection");
  if (sent == Transfer::kTimedOut) fail(method, "the server takes no call within " + format_number(timeout_s_) + " s");
  calls_[number] = {method, std::nullopt};
  return number;
}

RpcValue RpcClient::wait(std::uint32_t call) {
  return wait(call, timeout_s_);
}

RpcValue RpcClient::wait(std::uint32_t call, double timeout_s) {
  const auto found = calls_.find(call);
  if (found == calls_.end()) throw UsageError("call " + std::to_string(call) + " was not made, or its reply was taken");
  const std::string method = found->second.method;
  const Deadline deadline = deadline_after(timeout_s);
  while (!found->second.reply) {
    if (!stream_.is_open()) throw DataError(where(method) + "the connection was closed after an earlier error");
    receive(method, deadline, timeout_s);
  }
  Reply reply = std::move(*found->second.reply);
  calls_.erase(found);
  if (!reply.error.is_nil()) throw DataError(where(method) + "the server says: " + error_text(reply.error));
  return std::move(reply.result);
}

RpcValue RpcClient::call(const std::string& method, RpcArray arguments) {
  return wait(send(method, std::move(arguments)));
}

/// Waits for more bytes and takes the replies that they complete.
void RpcClient::receive(const std::string& method, Deadline deadline, double timeout_s) {
  const Transfer received = receive_some(stream_, buffer_, kReceiveBytes, {deadline, go_on_});
  if (received == Transfer::kTimedOut) fail(method, "no reply within " + format_number(timeout_s) + " s");
  if (received == Transfer::kClosed) {
    fail(method, buffer_.empty() ? "the server closed the connection before it replied"
                                 : "the server closed the connection in the middle of a reply");
  }
  try {
    while (const std::optional<std::size_t> size = scanner_.scan(buffer_)) {
      const RpcValue message = decode_rpc(std::span(buffer_).first(*size), limits_);
      buffer_.erase(buffer_.begin(), buffer_.begin() + static_cast<std::ptrdiff_t>(*size));
      take_reply(message, method);
    }
  } catch (const DataError& error) {
    if (!stream_.is_open()) throw;  // take_reply has said it
    fail(method, std::string("the reply ") + error.what());
  }
}

void RpcClient::take_reply(const RpcValue& message, const std::string& method) {
  const auto* parts = std::get_if<RpcArray>(&message.data);
  if (parts == nullptr || parts->size() != 4) {
    fail(method, "the reply is " + rpc_kind(message) + ", not [1, number, error, result]");
  }
  const std::optional<std::uint32_t> kind = call_number(parts->at(0));
  const std::optional<std::uint32_t> number = call_number(parts->at(1));
  if (!kind || *kind != 1 || !number) fail(method, "the reply is not [1, number, error, result]");
  const auto call = calls_.find(*number);
  if (call == calls_.end() || call->second.reply) {
    fail(method, "the reply is to call " + std::to_string(*number) + ", which is not waited for");
  }
  call->second.reply = Reply{parts->at(2), parts->at(3)};
}

}  // namespace pilotage
