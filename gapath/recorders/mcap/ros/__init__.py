"""What ROS 2 and Foxglove ask for beside a log: a bag's description, definitions, an animation."""
