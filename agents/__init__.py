"""Controllers that compete on Ship Gym: classical autopilots and learned policies."""
