// In place of ROS 2's client library, which is not in Debian 12: as much of its interface as docs/examples/ros2 uses.
// What is published is kept, and messages are handed to subscriptions by hand.
#pragma once

#include <chrono>
#include <cstdint>
#include <functional>
#include <map>
#include <memory>
#include <string>
#include <variant>
#include <vector>

namespace builtin_interfaces::msg {
struct Time {
  std::int32_t sec = 0;
  std::uint32_t nanosec = 0;
};
}  // namespace builtin_interfaces::msg

namespace std_msgs::msg {
struct Header {
  builtin_interfaces::msg::Time stamp;
  std::string frame_id;
};
}  // namespace std_msgs::msg

namespace rclcpp {

class Time {
 public:
  explicit Time(std::int64_t nanoseconds) : nanoseconds_(nanoseconds) {}
  std::int64_t nanoseconds() const { return nanoseconds_; }
  operator builtin_interfaces::msg::Time() const {
    return {static_cast<std::int32_t>(nanoseconds_ / 1'000'000'000),
            static_cast<std::uint32_t>(nanoseconds_ % 1'000'000'000)};
  }

 private:
  std::int64_t nanoseconds_;
};

struct SensorDataQoS {};

template <class Message>
struct Publisher {
  using SharedPtr = std::shared_ptr<Publisher>;
  void publish(const Message& message) { published.push_back(message); }
  std::vector<Message> published;
};

template <class Message>
struct Subscription {
  using SharedPtr = std::shared_ptr<Subscription>;
  std::function<void(const std::shared_ptr<const Message>&)> callback;
};

/// What a launch file would set.
using Parameter = std::variant<std::string, double, std::int64_t, bool>;
inline std::map<std::string, Parameter> parameters;

class Node {
 public:
  explicit Node(const std::string& name) : name_(name) {}

  template <class Value>
  Value declare_parameter(const std::string& name, const Value& otherwise) {
    const auto set = parameters.find(name);
    if (set == parameters.end()) return otherwise;
    if constexpr (std::is_same_v<Value, int>)
      return static_cast<int>(std::get<std::int64_t>(set->second));
    else
      return std::get<Value>(set->second);
  }
  template <class Message, class Qos>
  std::shared_ptr<Publisher<Message>> create_publisher(const std::string& topic, const Qos&) {
    auto publisher = std::make_shared<Publisher<Message>>();
    publishers[topic] = publisher;
    return publisher;
  }
  template <class Message, class Qos, class Callback>
  std::shared_ptr<Subscription<Message>> create_subscription(const std::string& topic, const Qos&, Callback callback) {
    auto subscription = std::make_shared<Subscription<Message>>();
    subscription->callback = callback;
    subscriptions[topic] = subscription;
    return subscription;
  }
  Time now() const { return Time(1'900'000'000'500'000'000); }

  template <class Message>
  const std::vector<Message>& published(const std::string& topic) const {
    return std::static_pointer_cast<Publisher<Message>>(publishers.at(topic))->published;
  }
  template <class Message>
  void receive(const std::string& topic, const Message& message) const {
    std::static_pointer_cast<Subscription<Message>>(subscriptions.at(topic))
        ->callback(std::make_shared<const Message>(message));
  }

 private:
  std::string name_;
  std::map<std::string, std::shared_ptr<void>> publishers, subscriptions;
};

}  // namespace rclcpp
